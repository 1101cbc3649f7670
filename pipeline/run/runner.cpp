#include "pipeline/run/runner.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <new>

#include "pipeline/base/error.h"
#include "pipeline/base/file.h"
#include "pipeline/base/quantity.h"
#include "pipeline/config/emit.h"
#include "pipeline/run/clock.h"
#include "pipeline/run/execution.h"

namespace periost {
namespace {

namespace fs = std::filesystem;

void write_text(const fs::path& path, const std::string& text) {
  AtomicFile file(path);
  file.write(text);
  file.commit();
}

// Whatever was thrown, as an Error.
Error as_error(const std::exception_ptr& thrown) {
  try {
    std::rethrow_exception(thrown);
  } catch (const Error& error) {
    return error;
  } catch (const std::bad_alloc&) {
    return {ErrorKind::kLimit, "limit.memory", "there is not enough memory for this step",
            "use a smaller image or a machine with more memory"};
  } catch (const std::exception& error) {
    return {ErrorKind::kInternal, "internal.unexpected", fmt::format("unexpected: {}", error.what()),
            "this is a fault of Periost; please report it"};
  } catch (...) {
    return {ErrorKind::kInternal, "internal.unexpected", "something that is no exception was thrown",
            "this is a fault of Periost; please report it"};
  }
}

}  // namespace

void Execution::run_chain() {
  write_text(folder_.path() / "config.yaml", emit_yaml(resolved_configuration(plan_)));
  check_memory(plan_, options_.memory_bytes);
  pin_inputs();
  run_rounds();
}

// Ends with the error of the first round, or with an interruption; other errors end the loop only.
void Execution::run_rounds() {
  for (std::uint32_t number = 1; ended_.empty(); ++number) {
    std::exception_ptr thrown;
    try {
      begin_round(number, rounds_.empty() ? nullptr : rounds_.back().made);
      run_steps();
    } catch (...) {
      thrown = std::current_exception();
    }
    end_round(thrown);
    if (manifest_.error) return;
    ended_ = rounds_.back().error ? "error" : why_to_end();
  }
  if (rounds_[best_].score.has_failed && options_.keep_going && !cancelled_.load()) complete_best();
  if (!plan_.feedback) return;
  context_for({}).info("rounds.ended", fmt::format("ended after round {} ({}); the best is round {}",
                                                   rounds_.back().number, ended_, rounds_[best_].number));
}

void Execution::begin_round(std::uint32_t number, std::shared_ptr<const Hints> hints) {
  round_ = {.number = number, .score = {}, .given = std::move(hints), .made = {}, .stages = {}, .error = {}};
  std::error_code ignored;
  fs::create_directories(output(), ignored);
  store_.begin_round();
  for (std::size_t step = 0; step < plan_.steps.size(); ++step) {
    if (plan_.steps[step].repeats) records_[step].reset();
  }
  if (number == 2)
    put_files(files_of(stages_of_round(rounds_[0])), folder_.path(), folder_.path() / round_folder(1));
  make_keys();
  if (plan_.max_rounds() == 1 || completes_) return;
  std::vector<std::string> changes;
  if (round_.given != nullptr && !round_.given->rounds.empty()) {
    for (const RoundChange& change : round_.given->rounds.back().changed)
      changes.push_back(change.key + ": " + change.text);
  }
  context_for({}).info("round.started",
                       fmt::format("round {} of at most {}{}{}", number, plan_.max_rounds(),
                                   changes.empty() ? "" : "; changed ", fmt::join(changes, ", ")));
}

// Writes what the round still holds, and sets it among the others.
void Execution::end_round(const std::exception_ptr& thrown) {
  std::optional<Error> error;
  if (thrown != nullptr) error = as_error(thrown);
  try {
    write_files(store_.unwritten());
  } catch (...) {
    if (!error) error = as_error(std::current_exception());
  }
  if (error) fail(*error, true);
  round_.stages = records_;
  rounds_.push_back(round_);
  const bool is_best =
      !round_.error && (rounds_.size() == 1 || is_better(round_.score, rounds_[best_].score));
  if (!is_best) return;
  best_ = rounds_.size() - 1;
  show_best();
}

std::string Execution::why_to_end() const {
  const Round& last = rounds_.back();
  const std::size_t had = last.given == nullptr ? 0 : last.given->hints.size();
  return reason_to_end({.round = last.number,
                        .best = rounds_[best_].number,
                        .max_rounds = plan_.max_rounds(),
                        .has_passed = !last.score.has_failed,
                        .has_new_hints = last.made != nullptr && last.made->hints.size() > had});
}

// With keep_going, the stages behind the failed gate of the best round, whose own results are in the cache.
void Execution::complete_best() {
  Round& best = rounds_[best_];
  const std::size_t ran = static_cast<std::size_t>(std::count_if(
      best.stages.begin(), best.stages.end(), [](const auto& stage) { return stage.has_value(); }));
  if (ran == plan_.steps.size()) return;
  const Round before = best;
  completes_ = true;
  std::exception_ptr thrown;
  try {
    begin_round(best.number, best.given);
    run_steps();
    write_files(store_.unwritten());
  } catch (...) {
    thrown = std::current_exception();
  }
  best.stages = records_;
  for (std::size_t step = 0; step < plan_.steps.size(); ++step) {
    if (before.stages[step]) best.stages[step] = before.stages[step];
  }
  show_best();
  if (thrown != nullptr) std::rethrow_exception(thrown);
}

// Puts the files of the best round to the top, in place of those of the round that was there.
void Execution::show_best() {
  const Round& best = rounds_[best_];
  const std::vector<std::string> names = files_of(stages_of_round(best));
  const fs::path own = folder_.path() / round_folder(best.number);
  if (best.number == 1) {
    if (rounds_.size() > 1) put_files(names, folder_.path(), own);
    return;
  }
  put_files(names, own, folder_.path());
  for (const std::string& name : files_of(stages_of_round(rounds_[shown_ - 1]))) {
    if (std::find(names.begin(), names.end(), name) == names.end()) fs::remove(folder_.path() / name);
  }
  shown_ = best.number;
}

// Those of the stages that rounds run again.
std::vector<StageRecord> Execution::stages_of_round(const Round& round) const {
  std::vector<StageRecord> stages;
  for (std::size_t step = 0; step < round.stages.size(); ++step) {
    if (plan_.steps[step].repeats && round.stages[step]) stages.push_back(*round.stages[step]);
  }
  return stages;
}

RoundRecord Execution::record_of(const Round& round) const {
  RoundRecord record;
  record.round = round.number;
  if (round.score.is_judged) {
    record.verdict = round.score.has_failed ? "fail" : round.score.has_warned ? "warn" : "pass";
  }
  record.failed_gates = round.score.failed_metrics;
  record.is_best = round.number == rounds_[best_].number;
  if (round.given != nullptr) record.hints = round.given->hints;
  if (round.made != nullptr && !round.made->rounds.empty()) {
    record.changed = round.made->rounds.back().changed;
    record.reason = round.made->rounds.back().reason;
  }
  record.error = round.error;
  if (rounds_.size() == 1) return record;
  record.folder = round_folder(round.number);
  record.stages = stages_of_round(round);
  for (StageRecord& stage : record.stages) {
    for (OutputRecord& output : stage.outputs) {
      if (!output.file.empty()) output.file = record.folder + "/" + output.file;
      for (FileRecord& file : output.files) file.file = record.folder + "/" + file.file;
    }
  }
  return record;
}

// `ends_round_only`: behind the first round an error leaves the run what the rounds before gave.
void Execution::fail(const Error& error, bool ends_round_only) {
  const bool is_over_memory = guard_ != nullptr && guard_->exceeded_bytes() > 0;
  const bool is_interrupted = !is_over_memory && cancelled_.load();
  Error cause = error;
  if (is_over_memory && error.kind() == ErrorKind::kInterrupted) {
    cause = Error(ErrorKind::kLimit, "limit.memory",
                  fmt::format("{} of memory were in use, more than the {} that --memory allows",
                              mebibytes(guard_->exceeded_bytes()), mebibytes(options_.memory_bytes)),
                  "allow more with --memory or use a smaller image");
  } else if (is_interrupted && error.kind() != ErrorKind::kInterrupted) {
    // Ctrl-C also reaches the worker processes, whose end is then no fault of theirs.
    cause = Error(ErrorKind::kInterrupted, "run.interrupted", "interrupted");
  }
  const ErrorRecord record{cause.code(), stage_, hidden(cause.what()), hidden(cause.hint())};
  round_.error = record;
  if (!ends_round_only || rounds_.empty() || cause.kind() == ErrorKind::kInterrupted) {
    manifest_.status = cause.kind() == ErrorKind::kInterrupted ? RunStatus::kInterrupted : RunStatus::kFailed;
    manifest_.exit_code = exit_code(cause.kind());
    manifest_.error = record;
  }
  const std::string text =
      cause.hint().empty() ? cause.what() : fmt::format("{}; {}", cause.what(), cause.hint());
  reporter_.report({Event::Level::kError, stage_, cause.code(), text});
}

// What the manifest tells of stages and rounds, and the status, which is that of the best round.
void Execution::conclude() {
  const bool is_over = !rounds_.empty();
  const auto& stages = is_over ? rounds_[best_].stages : records_;
  for (std::size_t step = 0; step < plan_.steps.size(); ++step) {
    const auto& record = plan_.steps[step].repeats ? stages[step] : records_[step];
    if (record) manifest_.stages.push_back(*record);
  }
  const bool is_judged = is_over && rounds_[best_].score.is_judged;
  if (is_judged || rounds_.size() > 1) {
    for (const Round& round : rounds_) manifest_.rounds.push_back(record_of(round));
    if (plan_.feedback) {
      const bool is_interrupted = manifest_.status == RunStatus::kInterrupted;
      manifest_.rounds.back().ended = ended_.empty() ? (is_interrupted ? "interrupted" : "error") : ended_;
    }
  }
  if (!manifest_.error) {
    if (is_judged && rounds_[best_].score.has_failed) {
      manifest_.status = RunStatus::kGateFailed;
      manifest_.exit_code = exit_code(ErrorKind::kQuality);
    } else if (is_judged && rounds_[best_].score.has_warned) {
      manifest_.status = RunStatus::kWarned;
    }
    cache().keep_only(all_keys_);
  }
  std::set<std::string> kept{"config.yaml", "events.ndjson"};
  const auto keep = [&kept](const std::vector<StageRecord>& records) {
    for (const std::string& name : files_of(records)) kept.insert(name);
  };
  keep(manifest_.stages);
  for (const RoundRecord& round : manifest_.rounds) keep(round.stages);
  folder_.remove_stale(kept);
}

void Execution::write_manifest() {
  const std::string text = manifest_json(manifest_);
  try {
    write_text(folder_.path() / "run.json", text);
  } catch (const Error&) {
    cache().keep_only({});  // makes room on a full disk
    write_text(folder_.path() / "run.json", text);
  }
}

Manifest Execution::run() {
  const auto start = Clock::now();
  begin();
  {
    const MemoryGuard guard(options_.memory_bytes, cancelled_);
    guard_ = &guard;
    try {
      run_chain();
    } catch (...) {
      fail(as_error(std::current_exception()));
    }
    guard_ = nullptr;
  }
  conclude();
  manifest_.wall_s = seconds_since(start);
  manifest_.peak_rss_bytes = std::max(manifest_.peak_rss_bytes, peak_resident_bytes());
  write_manifest();
  return manifest_;
}

void check_memory(const Plan& plan, std::uint64_t memory_bytes) {
  if (memory_bytes == 0) return;
  const std::uint64_t needed = resident_bytes() + plan.peak_bytes;
  if (needed <= memory_bytes) return;
  const auto largest =
      std::max_element(plan.steps.begin(), plan.steps.end(),
                       [](const PlanStep& a, const PlanStep& b) { return a.peak_bytes < b.peak_bytes; });
  const std::string where =
      largest == plan.steps.end() ? "" : fmt::format(", most of it in stage '{}'", largest->id);
  throw Error(ErrorKind::kLimit, "limit.memory",
              fmt::format("this chain needs about {}{}, more than the {} that --memory allows",
                          mebibytes(needed), where, mebibytes(memory_bytes)),
              fmt::format("allow at least --memory {}MiB or use a smaller image", needed / kMiB + 1));
}

Manifest run_plan(const Plan& plan, const Registry& registry, const RunOptions& options, Reporter& reporter,
                  std::atomic<bool>& cancelled) {
  return Execution(plan, registry, options, reporter, cancelled).run();
}

}  // namespace periost
