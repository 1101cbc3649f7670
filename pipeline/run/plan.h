#pragma once
// The checked chain: every option decoded, every input chosen, every preflight run, before a voxel is read.
#include <any>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/config/configuration.h"
#include "pipeline/stage/registry.h"

namespace periost {

// Where an input of a step comes from.
struct PlanInput {
  std::string port;                          // name of the input
  std::size_t step = 0;                      // index of an earlier step
  std::size_t output = 0;                    // index among that step's declared outputs
  ArtefactKind kind = ArtefactKind::kImage;  // that the input takes; the output's but for an isosurface
                                             // that stands for a surface, or a surface for one
};

struct PlanStep {
  std::string id;
  std::string kind;
  const Stage* stage = nullptr;                   // owned by the registry
  const StageDeclaration* declaration = nullptr;  // owned by the registry
  std::any options;                               // for run_any
  Value params;                                   // every key spelled out; paths absolute
  std::vector<PlanInput> inputs;                  // connected ports only, in the order of declaration
  std::map<std::string, Forecast> outputs;        // estimates, by port
  std::vector<std::filesystem::path> reads;       // files whose content the result depends on
  std::uint64_t peak_bytes = 0;                   // estimate of the step's own peak memory; 0: unknown
  SourcePlace place;                              // of the value of `stage:`
  std::string hints_port;  // input that takes the hints of the round before; empty: none
  bool gives_hints = false;
  bool repeats = false;  // a hint can reach it, so later rounds run it again
};

struct Plan {
  std::string name;
  std::uint64_t seed = 0;
  Provenance provenance;
  std::vector<std::filesystem::path> plugins;
  std::vector<PlanStep> steps;
  std::uint64_t peak_bytes = 0;  // estimate of the whole run: the largest step with what it must keep alive
  std::optional<Feedback> feedback;

  std::uint32_t max_rounds() const { return feedback ? feedback->max_rounds : 1; }
};

// One step of one round.
struct UnrolledStep {
  std::uint32_t round = 1;
  std::size_t step = 0;
  friend bool operator==(const UnrolledStep&, const UnrolledStep&) = default;
};

// The steps of all rounds in the order in which they run if no round passes: each step in the first round, in
// later ones those that a hint can reach.
std::vector<UnrolledStep> unrolled(const Plan& plan);

// Checks a configuration against the known stages; diagnostics are then in the order of the file. All
// problems are added to `diagnostics`, each with its place; a plan with errors among them must not be run. A
// stage takes the newest artefact of each kind it needs; `from:` picks another; of several inputs of one
// kind, all but the first must be picked. Where no stage makes an isosurface, a surface stands for it. With
// `feedback`, inputs of kind hints take what the last stage that gives hints gave in the round before
// (nothing in the first round); without, they are never connected. The registry must outlive the plan.
Plan make_plan(const Configuration& configuration, const Registry& registry, Diagnostics& diagnostics);

// The configuration that this plan came from with every default, id and input spelled out, as it goes to
// config.yaml (emit with config/emit.h). Paths are written relative to `folder`, where that file will be;
// absolute if empty.
Value resolved_configuration(const Plan& plan, const std::filesystem::path& folder = {});

}  // namespace periost
