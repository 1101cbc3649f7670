#include "pipeline/run/runner.h"

#include <fmt/format.h>
#include <malloc.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <new>

#include "pipeline/base/error.h"
#include "pipeline/base/file.h"
#include "pipeline/base/hash.h"
#include "pipeline/base/quantity.h"
#include "pipeline/config/emit.h"
#include "pipeline/io/archive.h"
#include "pipeline/param/render.h"
#include "pipeline/run/artefact_files.h"
#include "pipeline/run/artefact_store.h"
#include "pipeline/run/cache.h"
#include "pipeline/run/inputs.h"
#include "pipeline/run/resources.h"

namespace periost {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using Place = ArtefactStore::Place;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

void write_text(const fs::path& path, const std::string& text) {
  AtomicFile file(path);
  file.write(text);
  file.commit();
}

std::string verdict_name(Verdict verdict) {
  switch (verdict) {
    case Verdict::kPass:
      return "pass";
    case Verdict::kWarn:
      return "warn";
    case Verdict::kFail:
      return "fail";
  }
  return "fail";
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

std::set<ArtefactKind> kinds_as_files(const RunOptions& options) {
  std::set<ArtefactKind> kinds;
  for (int number = 0; number < kArtefactKinds; ++number) {
    const auto kind = static_cast<ArtefactKind>(number);
    const bool is_wanted = is_always_saved(kind) || options.save.contains(kind);
    if (is_wanted && !file_name_of(kind).empty()) kinds.insert(kind);
  }
  return kinds;
}

// One run of one plan, from the taken folder to run.json.
class Execution {
 public:
  Execution(const Plan& plan, const Registry& registry, const RunOptions& options, Reporter& reporter,
            std::atomic<bool>& cancelled)
      : plan_(plan),
        registry_(registry),
        options_(options),
        reporter_(reporter),
        cancelled_(cancelled),
        folder_(fs::absolute(options.output).lexically_normal(), options.existing),
        cache_(folder_.cache(), folder_.path()),
        store_(plan, kinds_as_files(options)) {}

  ~Execution() { reporter_.close_events(); }
  Execution(const Execution&) = delete;
  Execution& operator=(const Execution&) = delete;

  Manifest run();

 private:
  void begin();
  void pin_inputs();
  std::string key_of(std::size_t step, const Value& params) const;
  void run_chain();
  void run_step(std::size_t step);
  bool take_from_cache(std::size_t step, StageRecord& record);
  CacheEntry compute(std::size_t step);
  std::vector<FileRecord> deck_files(const std::vector<Artefact>& outputs) const;
  void remember(std::size_t step, CacheEntry& entry);
  void accept(std::size_t step, const CacheEntry& entry, StageRecord& record);
  void write_files(const std::vector<Place>& places);
  void judge(const Artefact& artefact);
  void fail(const Error& error);
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
  Cache cache_;
  ArtefactStore store_;
  Manifest manifest_;
  std::map<fs::path, InputContent> contents_;
  std::vector<std::string> keys_;  // of the steps
  std::string stage_;              // id of the step at work, for errors
  const MemoryGuard* guard_ = nullptr;
  bool caches_ = true;
  bool gate_failed_ = false;
};

Context Execution::context_for(const std::string& stage) const {
  Context context;
  context.sink = reporter_.sink();
  context.stage = stage;
  context.run_name = plan_.name;
  context.cancelled = &cancelled_;
  context.seed = plan_.seed;
  context.threads = manifest_.threads;
  context.memory_bytes = options_.memory_bytes;
  context.output = folder_.path();
  context.scratch = folder_.scratch();
  context.workers = options_.workers;
  return context;
}

std::string Execution::hidden(const std::string& text) const {
  std::vector<fs::path> files;
  for (const PlanStep& step : plan_.steps) {
    files.insert(files.end(), step.reads.begin(), step.reads.end());
    const auto paths = input_paths(step.declaration->params->params(), step.params);
    files.insert(files.end(), paths.begin(), paths.end());
  }
  return without_paths(text, files, plan_.provenance.paths);
}

void Execution::begin() {
  manifest_.name = plan_.name;
  manifest_.command = options_.command;
  manifest_.paths = plan_.provenance.paths;
  manifest_.seed = plan_.seed;
  manifest_.threads = options_.threads > 0 ? options_.threads : core_count();
  manifest_.memory_bytes = options_.memory_bytes;
  manifest_.started = utc_now();
  reporter_.open_events(folder_.path() / "events.ndjson",
                        [this](const std::string& text) { return hidden(text); });
}

// Reads the content of every input once and makes the keys of all steps from it.
void Execution::pin_inputs() {
  for (std::size_t i = 0; i < plan_.steps.size(); ++i) {
    const PlanStep& step = plan_.steps[i];
    stage_ = step.id;
    const std::vector<ParamInfo>& infos = step.declaration->params->params();
    std::vector<fs::path> paths = input_paths(infos, step.params);
    paths.insert(paths.end(), step.reads.begin(), step.reads.end());
    for (const fs::path& path : paths) {
      context_for(stage_).check_cancelled();
      if (contents_.contains(path)) continue;
      const InputContent& content = contents_.emplace(path, read_content(path)).first->second;
      for (const FileRecord& file : content.files) {
        const FileRecord record{provenance_path(file.file, manifest_.paths), file.bytes, file.xxh128};
        const auto& inputs = manifest_.inputs;
        if (std::find(inputs.begin(), inputs.end(), record) == inputs.end())
          manifest_.inputs.push_back(record);
      }
    }
    const Value params = with_input_paths(
        infos, step.params, [this](const fs::path& path) { return "xxh128:" + contents_.at(path).hash; });
    keys_.push_back(key_of(i, params));
  }
  stage_.clear();
}

std::string Execution::key_of(std::size_t index, const Value& params) const {
  const PlanStep& step = plan_.steps[index];
  const Registry::Entry* entry = registry_.find(step.kind);
  const bool is_plugin = entry != nullptr && fs::is_regular_file(entry->origin);
  StageKey key{.stage = step.kind,
               .version = step.declaration->version,
               .origin = is_plugin ? hash_file(entry->origin) : "built in",
               .params = flow_text(params),
               .seed = plan_.seed,
               .run_name = {},
               .inputs = {}};
  for (const Port& output : step.declaration->outputs) {
    if (output.kind == ArtefactKind::kDeck) key.run_name = plan_.name;
  }
  for (const fs::path& file : step.reads) key.inputs.push_back(contents_.at(file).hash);
  for (const PlanInput& input : step.inputs) {
    key.inputs.push_back(fmt::format("{}:{}:{}", input.port, keys_[input.step], input.output));
  }
  return hash_of(key);
}

void Execution::run_chain() {
  write_text(folder_.path() / "config.yaml", emit_yaml(resolved_configuration(plan_)));
  check_memory(plan_, options_.memory_bytes);
  pin_inputs();
  for (std::size_t step = 0; step < plan_.steps.size(); ++step) {
    if (gate_failed_ && !options_.keep_going) {
      context_for({}).warn("run.gate_failed", "a quality gate failed: the stages behind it do not run");
      return;
    }
    run_step(step);
  }
}

void Execution::run_step(std::size_t index) {
  const PlanStep& step = plan_.steps[index];
  const Context context = context_for(step.id);
  stage_ = step.id;
  context.check_cancelled();
  context.debug("stage.started", "started");
  const auto start = Clock::now();
  const double cpu = cpu_seconds();
  const std::uint64_t children = children_peak_bytes();
  reset_peak_resident();

  StageRecord record{.id = step.id, .kind = step.kind};
  if (!take_from_cache(index, record)) {
    CacheEntry entry = compute(index);
    remember(index, entry);
    accept(index, entry, record);
  }
  record.wall_s = seconds_since(start);
  record.cpu_s = cpu_seconds() - cpu;
  record.peak_rss_bytes = peak_resident_bytes();
  if (children_peak_bytes() > children)
    record.peak_rss_bytes = std::max(record.peak_rss_bytes, children_peak_bytes());
  manifest_.peak_rss_bytes = std::max(manifest_.peak_rss_bytes, record.peak_rss_bytes);
  context.info("stage.finished",
               fmt::format("{}{:.2f} s", record.cached ? "from the cache, " : "", record.wall_s));
  manifest_.stages.push_back(std::move(record));

  write_files(store_.due_after(index));
  store_.release_after(index);
  ::malloc_trim(0);  // memory that stages freed no longer counts against the budget
  stage_.clear();
}

bool Execution::take_from_cache(std::size_t step, StageRecord& record) {
  if (options_.existing != ExistingFolder::kResume) return false;
  const auto entry = cache_.find(keys_[step]);
  if (!entry || entry->outputs.size() != plan_.steps[step].declaration->outputs.size()) return false;
  record.cached = true;
  accept(step, *entry, record);
  return true;
}

CacheEntry Execution::compute(std::size_t index) {
  const PlanStep& step = plan_.steps[index];
  Inputs inputs;
  for (const PlanInput& input : step.inputs) {
    const Artefact& artefact = store_.at({input.step, input.output});
    inputs.set(input.port, kind_of(artefact) == input.kind ? artefact : as_surface(artefact));
  }
  Context context = context_for(step.id);
  CacheEntry entry;
  entry.outputs = step.stage->run_any(step.options, inputs, context).artefacts();
  context.check_cancelled();
  const std::vector<Port>& ports = step.declaration->outputs;
  const bool fits =
      std::equal(ports.begin(), ports.end(), entry.outputs.begin(), entry.outputs.end(),
                 [](const Port& port, const Artefact& artefact) { return port.kind == kind_of(artefact); });
  if (!fits) {
    throw Error(ErrorKind::kInternal, "stage.bad_outputs",
                "the stage did not return the outputs that it declares", "this is a fault of the stage");
  }
  entry.files = deck_files(entry.outputs);
  return entry;
}

std::vector<FileRecord> Execution::deck_files(const std::vector<Artefact>& outputs) const {
  std::vector<FileRecord> files;
  for (const Artefact& artefact : outputs) {
    if (kind_of(artefact) != ArtefactKind::kDeck) continue;
    for (const std::string& name : std::get<std::shared_ptr<const Deck>>(artefact)->files) {
      const fs::path path = folder_.path() / name;
      FileRecord record{name, 0, hash_file(path)};
      record.bytes = fs::file_size(path);
      files.push_back(std::move(record));
    }
  }
  return files;
}

// The cache is a convenience: when the disk is full it gives way to the results.
void Execution::remember(std::size_t step, CacheEntry& entry) {
  if (!caches_) return;
  try {
    cache_.store(keys_[step], entry);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::kLimit) throw;
    caches_ = false;
    cache_.keep_only({});
    context_for(stage_).warn("run.cache_off", fmt::format("results are not cached: {}", error.what()));
  }
}

void Execution::accept(std::size_t step, const CacheEntry& entry, StageRecord& record) {
  for (std::size_t output = 0; output < entry.outputs.size(); ++output) {
    const Artefact& artefact = entry.outputs[output];
    OutputRecord made{.kind = std::string(name_of(kind_of(artefact)))};
    made.xxh128 = output < entry.hashes.size() ? entry.hashes[output] : hash_artefact(artefact);
    made.facts = facts_of(artefact);
    if (kind_of(artefact) == ArtefactKind::kDeck) made.files = entry.files;
    record.outputs.push_back(std::move(made));
    judge(artefact);
    store_.put({step, output}, artefact);
  }
}

void Execution::judge(const Artefact& artefact) {
  if (kind_of(artefact) != ArtefactKind::kQuality) return;
  const Verdict verdict = std::get<std::shared_ptr<const QualityReport>>(artefact)->verdict;
  gate_failed_ = gate_failed_ || verdict == Verdict::kFail;
  if (verdict == Verdict::kWarn) manifest_.status = RunStatus::kWarned;
  manifest_.rounds = {{1, verdict_name(verdict)}};
}

void Execution::write_files(const std::vector<Place>& places) {
  for (const Place& place : places) {
    const Artefact& artefact = store_.at(place);
    const std::string name = file_name_of(kind_of(artefact));
    write_artefact_file(artefact, folder_.path());
    OutputRecord& record = manifest_.stages.at(place.step).outputs.at(place.output);
    record.file = name;
    record.xxh128 = hash_file(folder_.path() / name);
    store_.mark_written(place);
  }
}

void Execution::fail(const Error& error) {
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
  manifest_.status = cause.kind() == ErrorKind::kInterrupted ? RunStatus::kInterrupted : RunStatus::kFailed;
  manifest_.exit_code = exit_code(cause.kind());
  manifest_.error = ErrorRecord{cause.code(), stage_, hidden(cause.what()), hidden(cause.hint())};
  const std::string text =
      cause.hint().empty() ? cause.what() : fmt::format("{}; {}", cause.what(), cause.hint());
  reporter_.report({Event::Level::kError, stage_, cause.code(), text});
}

void Execution::conclude() {
  if (!manifest_.error) {
    if (gate_failed_) {
      manifest_.status = RunStatus::kGateFailed;
      manifest_.exit_code = exit_code(ErrorKind::kQuality);
    }
    cache_.keep_only({keys_.begin(), keys_.end()});
  }
  std::set<std::string> kept{"config.yaml", "events.ndjson"};
  for (const StageRecord& stage : manifest_.stages) {
    for (const OutputRecord& output : stage.outputs) {
      kept.insert(output.file);
      for (const FileRecord& file : output.files) kept.insert(file.file);
    }
  }
  folder_.remove_stale(kept);
}

void Execution::write_manifest() {
  const std::string text = manifest_json(manifest_);
  try {
    write_text(folder_.path() / "run.json", text);
  } catch (const Error&) {
    cache_.keep_only({});  // makes room on a full disk
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
    try {
      write_files(store_.unwritten());
    } catch (...) {
      if (!manifest_.error) fail(as_error(std::current_exception()));
    }
    guard_ = nullptr;
  }
  conclude();
  manifest_.wall_s = seconds_since(start);
  manifest_.peak_rss_bytes = std::max(manifest_.peak_rss_bytes, peak_resident_bytes());
  write_manifest();
  return manifest_;
}

}  // namespace

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
