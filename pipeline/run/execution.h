#pragma once
// One run of one plan, for runner.cpp only: run_steps and what it calls make the artefacts of a round
// (execution.cpp); the rest decides on rounds, files at the top and the manifest (runner.cpp).
#include <exception>
#include <map>
#include <memory>
#include <optional>
#include <set>

#include "pipeline/base/error.h"
#include "pipeline/run/artefact_store.h"
#include "pipeline/run/cache.h"
#include "pipeline/run/inputs.h"
#include "pipeline/run/resources.h"
#include "pipeline/run/rounds.h"
#include "pipeline/run/runner.h"

namespace periost {

// A round that is over.
struct Round {
  std::uint32_t number = 1;
  RoundScore score;
  std::shared_ptr<const Hints> given, made;        // null: none
  std::vector<std::optional<StageRecord>> stages;  // by step
  std::optional<ErrorRecord> error;
};

// One run of one plan, from the taken folder to run.json.
class Execution {
 public:
  Execution(const Plan& plan, const Registry& registry, const RunOptions& options, Reporter& reporter,
            std::atomic<bool>& cancelled);
  ~Execution() { reporter_.close_events(); }
  Execution(const Execution&) = delete;
  Execution& operator=(const Execution&) = delete;

  Manifest run();

 private:
  void begin();
  void pin_inputs();
  void make_keys();
  std::string key_of(std::size_t step) const;
  std::shared_ptr<const Hints> hints_for(const PlanStep& step) const;
  std::filesystem::path output() const;
  void run_chain();
  void run_rounds();
  void begin_round(std::uint32_t number, std::shared_ptr<const Hints> hints);
  void run_steps();
  void end_round(const std::exception_ptr& thrown);
  std::string why_to_end() const;
  void complete_best();
  void show_best();
  std::vector<StageRecord> stages_of_round(const Round& round) const;
  RoundRecord record_of(const Round& round) const;
  void run_step(std::size_t step);
  bool take_from_cache(std::size_t step, StageRecord& record);
  Cache cache() const { return {folder_.cache(), output()}; }
  CacheEntry compute(std::size_t step);
  std::vector<FileRecord> deck_files(const std::vector<Artefact>& outputs) const;
  void remember(std::size_t step, CacheEntry& entry);
  void accept(std::size_t step, const CacheEntry& entry, StageRecord& record);
  void write_files(const std::vector<ArtefactStore::Place>& places);
  void judge(std::size_t step, const Artefact& artefact);
  void fail(const Error& error, bool ends_round_only = false);
  void conclude();
  void write_manifest();
  std::string hidden(const std::string& text) const;
  Context context_for(const std::string& stage) const;

  const Plan& plan_;
  const Registry& registry_;
  const RunOptions& options_;
  Reporter& reporter_;
  std::atomic<bool>& cancelled_;
  RunFolder folder_;
  ArtefactStore store_;
  Manifest manifest_;
  std::map<std::filesystem::path, InputContent> contents_;
  std::vector<std::string> params_;  // of the steps, with input paths replaced by the hash of their content
  std::vector<std::string> keys_;    // of the steps in this round
  std::set<std::string> all_keys_, made_keys_;       // of all rounds; of what was computed or found
  std::vector<std::optional<StageRecord>> records_;  // of the steps; what runs once keeps that of round 1
  Round round_;                                      // at work
  std::vector<Round> rounds_;                        // over
  std::size_t best_ = 0;                             // among them
  std::uint32_t shown_ = 1;                          // round whose files lie at the top
  bool completes_ = false;                           // runs what stands behind a failed gate
  std::string ended_;
  std::string stage_;  // id of the step at work, for errors
  const MemoryGuard* guard_ = nullptr;
  bool caches_ = true;
};

}  // namespace periost
