#pragma once
// A chain as the user configured it: read, expanded, overridden and cut into stages, but not yet checked
// against the stages that exist (run/plan.h does that).
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/base/diagnostic.h"
#include "pipeline/param/param_info.h"
#include "pipeline/param/value.h"

namespace periost {

// One entry of `from:`.
struct InputChoice {
  std::string port;    // the input it is for; empty: every input of a matching kind
  std::string source;  // id of the stage, or `id.output` to pick one of several outputs of a kind
  SourcePlace place;
};

// One entry of `chain:`.
struct StageEntry {
  std::string kind;               // its `stage:`
  std::string id;                 // its `id:`, or kind, kind_2, ... in the order of the chain
  std::vector<InputChoice> from;  // what `from:` asks for
  Value params;                   // a map: all other keys
  SourcePlace place;              // of the value of `stage:`
};

// How a run repeats itself until its gates pass.
struct Feedback {
  std::string until = "pass";
  std::uint32_t max_rounds = 4;
};

// What run.json may tell of where data came from.
struct Provenance {
  enum class Paths { kFull, kBasename, kNone };
  bool dicom_uids = false;
  Paths paths = Paths::kBasename;
};

struct Configuration {
  std::filesystem::path file;    // as given
  std::filesystem::path folder;  // absolute; relative paths in the document start here
  std::string name;              // `name:`, or the file's stem
  std::vector<StageEntry> chain;
  std::optional<Feedback> feedback;
  SourcePlace feedback_place;
  std::vector<std::filesystem::path> plugins;
  Provenance provenance;
  std::uint64_t seed = 0;
};

// Reads a configuration file, expands ${ENV}, applies the overrides ("decimate.distance=0.3voxel", in order)
// and decodes the top level. Everything wrong is added to `diagnostics`; with errors among them the result is
// only good for further checks. Never throws for what the file holds; a missing file is a diagnostic, too.
Configuration read_configuration(const std::filesystem::path& file, const std::vector<std::string>& overrides,
                                 Diagnostics& diagnostics);

// The same from a text; `file` names it in places and gives the folder.
Configuration parse_configuration(const std::string& text, const std::filesystem::path& file,
                                  const std::vector<std::string>& overrides, Diagnostics& diagnostics);

// The keys of the top level, for `schema` and the documentation.
std::vector<ParamInfo> top_level_params();

}  // namespace periost
