#pragma once
// Leaves the tetrahedral mesh in the output folder, in the formats of solvers.
#include <string>
#include <vector>

#include "pipeline/base/context.h"
#include "pipeline/data/deck.h"
#include "pipeline/data/tet_mesh.h"

namespace periost {

enum class DeckFormat {
  kAbaqus,  // NAME.inp, for Abaqus and CalculiX: see io/abaqus_deck.h
  kVtu,     // NAME.vtu: see io/volume_write.h
};

struct WriteDeckOptions {
  std::vector<DeckFormat> format{DeckFormat::kAbaqus};  // one file each
  std::string name;                                     // of the files, without ending; empty: the run's
};

// Writes into context.output, which may be empty for the working folder. The name falls back to
// context.run_name and then to "mesh". Deterministic. Errors as the writers'; kQuality, "deck.inverted" if a
// tetrahedron does not have a positive volume, since solvers then stop or go wrong in silence.
Deck write_deck(const TetMesh& mesh, const WriteDeckOptions& options, const Context& context);

// The name is one that a file in the output folder can have: no separators, not hidden.
bool is_plain_name(const std::string& name);

}  // namespace periost
