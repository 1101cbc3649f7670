#pragma once
// Executes a checked plan and leaves what docs/run_folder.md describes.
//
// Stages run one after the other; inside they use context.threads. Results do not depend on threads, on the
// memory budget or on whether they came from the cache. Once an artefact is needed by no later stage and its
// file is written, it is freed. A stage that returns a quality report with a failed verdict ends the chain
// unless `keep_going`.
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "pipeline/run/manifest.h"
#include "pipeline/run/plan.h"
#include "pipeline/run/reporter.h"
#include "pipeline/run/run_folder.h"

namespace periost {

struct RunOptions {
  std::filesystem::path output;  // the run folder
  ExistingFolder existing = ExistingFolder::kRefuse;
  int threads = 0;                   // 0: all cores
  std::uint64_t memory_bytes = 0;    // budget for this process; 0: none
  bool keep_going = false;           // run on behind a failed gate
  std::set<ArtefactKind> save;       // kinds left as files beyond those that always are
  std::filesystem::path workers;     // folder of the worker programs
  std::vector<std::string> command;  // for run.json: words behind the program's name
};

// Runs the plan. What goes wrong inside is reported as an error event and recorded in run.json, and the
// manifest tells status and exit code. `cancelled` ends the run at the next poll (status interrupted); the
// memory guard sets it, too. Throws Error only when the folder cannot be taken (see RunFolder) or run.json
// cannot be written.
Manifest run_plan(const Plan& plan, const Registry& registry, const RunOptions& options, Reporter& reporter,
                  std::atomic<bool>& cancelled);

// Keeps a plan from starting whose estimate exceeds the budget. Throws Error{kLimit, "limit.memory"} that
// names the largest stage and the smallest budget that should do; a budget of 0 allows everything.
void check_memory(const Plan& plan, std::uint64_t memory_bytes);

}  // namespace periost
