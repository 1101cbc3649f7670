#include "pipeline/run/execution.h"

#include <fmt/format.h>
#include <malloc.h>

#include <algorithm>
#include <chrono>

#include "pipeline/base/file.h"
#include "pipeline/base/hash.h"
#include "pipeline/geometry/isosurface_of_surface.h"
#include "pipeline/io/archive.h"
#include "pipeline/param/render.h"
#include "pipeline/run/artefact_files.h"
#include "pipeline/run/clock.h"

namespace periost {
namespace {

namespace fs = std::filesystem;
using Place = ArtefactStore::Place;

std::set<ArtefactKind> kinds_as_files(const Plan& plan, const RunOptions& options) {
  std::set<ArtefactKind> kinds;
  for (int number = 0; number < kArtefactKinds; ++number) {
    const auto kind = static_cast<ArtefactKind>(number);
    const bool is_wanted = is_always_saved(kind) || options.save.contains(kind) ||
                           (kind == ArtefactKind::kHints && plan.feedback.has_value());
    if (is_wanted && !file_name_of(kind).empty()) kinds.insert(kind);
  }
  return kinds;
}

// What stands for an artefact of another kind: an isosurface's triangles for a surface, and the other way
// round.
Artefact as_kind(const Artefact& artefact, ArtefactKind kind) {
  if (kind_of(artefact) == kind) return artefact;
  if (kind == ArtefactKind::kSurface) return as_surface(artefact);
  const auto& surface = std::get<std::shared_ptr<const SurfaceMesh>>(artefact);
  return std::make_shared<const Isosurface>(isosurface_of_surface(*surface));
}

}  // namespace

Execution::Execution(const Plan& plan, const Registry& registry, const RunOptions& options,
                     Reporter& reporter, std::atomic<bool>& cancelled)
    : plan_(plan),
      registry_(registry),
      options_(options),
      reporter_(reporter),
      cancelled_(cancelled),
      folder_(std::filesystem::absolute(options.output).lexically_normal(), options.existing),
      store_(plan, kinds_as_files(plan, options)),
      records_(plan.steps.size()) {}

Context Execution::context_for(const std::string& stage) const {
  Context context;
  context.sink = reporter_.sink();
  context.stage = stage;
  context.run_name = plan_.name;
  context.cancelled = &cancelled_;
  context.seed = plan_.seed;
  context.threads = manifest_.threads;
  context.memory_bytes = options_.memory_bytes;
  context.output = output();
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
    params_.push_back(flow_text(with_input_paths(
        infos, step.params, [this](const fs::path& path) { return "xxh128:" + contents_.at(path).hash; })));
  }
  stage_.clear();
}

void Execution::make_keys() {
  keys_.clear();
  for (std::size_t step = 0; step < plan_.steps.size(); ++step) keys_.push_back(key_of(step));
  all_keys_.insert(keys_.begin(), keys_.end());
}

std::string Execution::key_of(std::size_t index) const {
  const PlanStep& step = plan_.steps[index];
  const Registry::Entry* entry = registry_.find(step.kind);
  const bool is_plugin = entry != nullptr && fs::is_regular_file(entry->origin);
  StageKey key{.stage = step.kind,
               .version = step.declaration->version,
               .origin = is_plugin ? hash_file(entry->origin) : "built in",
               .params = params_[index],
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
  if (const auto hints = hints_for(step))
    key.inputs.push_back(fmt::format("{}:{}", step.hints_port, hash_artefact(hints)));
  return hash_of(key);
}

// What a stage is given of the round before: one that gives hints itself adds to all of them, any other takes
// those that are meant for it. Without any it runs as in the first round.
std::shared_ptr<const Hints> Execution::hints_for(const PlanStep& step) const {
  if (step.hints_port.empty() || round_.given == nullptr) return nullptr;
  if (step.gives_hints) return round_.given;
  Hints some = addressed_to(*round_.given, step.kind);
  return some.hints.empty() ? nullptr : std::make_shared<const Hints>(std::move(some));
}

fs::path Execution::output() const {
  return round_.number == 1 ? folder_.path() : folder_.path() / round_folder(round_.number);
}

// The steps of a round, but for those that ran once and for all. A failed gate ends it.
void Execution::run_steps() {
  const bool goes_on = completes_ || (options_.keep_going && round_.number == plan_.max_rounds());
  for (std::size_t step = 0; step < plan_.steps.size(); ++step) {
    if (round_.score.has_failed && !goes_on) {
      context_for({}).warn("run.gate_failed", "a quality gate failed: the stages behind it do not run");
      return;
    }
    if (!plan_.steps[step].repeats && records_[step]) continue;
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
  records_[index] = std::move(record);
  made_keys_.insert(keys_[index]);

  write_files(store_.due_after(index));
  store_.release_after(index);
  ::malloc_trim(0);  // memory that stages freed no longer counts against the budget
  stage_.clear();
}

bool Execution::take_from_cache(std::size_t step, StageRecord& record) {
  if (options_.existing != ExistingFolder::kResume && !made_keys_.contains(keys_[step])) return false;
  const auto entry = cache().find(keys_[step]);
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
    inputs.set(input.port, as_kind(artefact, input.kind));
  }
  if (const auto hints = hints_for(step)) inputs.set(step.hints_port, hints);
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
      const fs::path path = output() / name;
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
    cache().store(keys_[step], entry);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::kLimit) throw;
    caches_ = false;
    cache().keep_only({});
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
    judge(step, artefact);
    store_.put({step, output}, artefact);
  }
}

void Execution::judge(std::size_t step, const Artefact& artefact) {
  if (kind_of(artefact) == ArtefactKind::kHints)
    round_.made = std::get<std::shared_ptr<const Hints>>(artefact);
  if (kind_of(artefact) == ArtefactKind::kQuality)
    add_report(*std::get<std::shared_ptr<const QualityReport>>(artefact), step, round_.score);
}

void Execution::write_files(const std::vector<Place>& places) {
  for (const Place& place : places) {
    const Artefact& artefact = store_.at(place);
    const std::string name = file_name_of(kind_of(artefact));
    write_artefact_file(artefact, output());
    OutputRecord& record = records_.at(place.step)->outputs.at(place.output);
    record.file = name;
    record.xxh128 = hash_file(output() / name);
    store_.mark_written(place);
  }
}

}  // namespace periost
