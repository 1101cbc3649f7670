#pragma once
// Files written for a solver or another program; the last artefact of most chains.
#include <string>
#include <vector>

namespace periost {

// Names are relative to the run's output folder.
struct Deck {
  std::vector<std::string> files;
};

}  // namespace periost
