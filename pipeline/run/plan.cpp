#include "pipeline/run/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "pipeline/run/connect.h"

namespace periost {
namespace {

// Where the problem of a key stands: at the longest part of its path that the document has.
SourcePlace place_of_key(const StageEntry& entry, const std::string& key) {
  for (const Value::Entry& e : entry.params.entries) {
    const bool is_start = key == e.key || key.rfind(e.key + ".", 0) == 0 || key.rfind(e.key + "[", 0) == 0;
    if (is_start) return e.value.place;
  }
  return entry.place;
}

// Names the stage in all diagnostics from `first` on and gives those without a place that of their key.
void complete(Diagnostics& diagnostics, std::size_t first, const StageEntry& entry) {
  for (std::size_t i = first; i < diagnostics.size(); ++i) {
    diagnostics[i].stage = entry.id;
    if (diagnostics[i].place.file.empty()) diagnostics[i].place = place_of_key(entry, diagnostics[i].key);
  }
}

void add_unknown_stage(const StageEntry& entry, const Registry& registry, Diagnostics& diagnostics) {
  const std::string near = registry.nearest(entry.kind);
  diagnostics.push_back(
      {Severity::kError,
       "config.unknown_stage",
       {},
       "stage",
       entry.place,
       fmt::format("unknown stage '{}'", entry.kind),
       near.empty() ? "'periost stages' lists them" : fmt::format("did you mean '{}'?", near)});
}

// The dry run of a step whose options and inputs are good.
void run_preflight(PlanStep& step, const StageEntry& entry, const std::vector<PlanStep>& earlier,
                   Diagnostics& diagnostics) {
  Preflight preflight;
  for (const PlanInput& input : step.inputs) {
    const PlanStep& producer = earlier[input.step];
    const auto found = producer.outputs.find(producer.declaration->outputs[input.output].name);
    preflight.inputs[input.port] = found == producer.outputs.end() ? Forecast{} : found->second;
  }
  const std::size_t before = diagnostics.size();
  step.stage->preflight_any(step.options, preflight);
  diagnostics.insert(diagnostics.end(), preflight.diagnostics.begin(), preflight.diagnostics.end());
  complete(diagnostics, before, entry);
  step.outputs = std::move(preflight.outputs);
  step.peak_bytes = preflight.peak_bytes;
  step.reads = std::move(preflight.reads);
}

PlanStep make_step(const StageEntry& entry, const Configuration& configuration, const Registry& registry,
                   const std::vector<PlanStep>& earlier, Diagnostics& diagnostics) {
  PlanStep step;
  step.id = entry.id;
  step.kind = entry.kind;
  step.place = entry.place;
  const Registry::Entry* known = registry.find(entry.kind);
  if (known == nullptr) {
    if (!entry.kind.empty()) add_unknown_stage(entry, registry, diagnostics);
    return step;
  }
  step.stage = known->stage.get();
  step.declaration = &known->declaration;
  const std::size_t before = diagnostics.size();
  step.options = step.declaration->params->decode(entry.params, diagnostics, configuration.folder);
  complete(diagnostics, before, entry);
  step.inputs = connect(entry, *step.declaration, earlier, configuration.chain, diagnostics);
  if (diagnostics.size() != before) return step;
  step.params = step.declaration->params->encode(step.options);
  run_preflight(step, entry, earlier, diagnostics);
  return step;
}

// A rough size of an artefact that is kept alive, from what is known of it.
std::uint64_t forecast_bytes(ArtefactKind kind, const Forecast& forecast) {
  const std::uint64_t voxels = static_cast<std::uint64_t>(forecast.dims[0]) *
                               static_cast<std::uint64_t>(forecast.dims[1]) *
                               static_cast<std::uint64_t>(forecast.dims[2]);
  switch (kind) {
    case ArtefactKind::kImage:
      return voxels * 4;
    case ArtefactKind::kMask:
      return voxels;
    case ArtefactKind::kIsosurface:
      return forecast.triangles * 64;
    case ArtefactKind::kSimplexMesh:
      return forecast.triangles * 80;
    case ArtefactKind::kSurface:
      return forecast.triangles * 24;
    case ArtefactKind::kTetMesh:
      return forecast.tets * 32;
    case ArtefactKind::kQuality:
    case ArtefactKind::kHints:
    case ArtefactKind::kDeck:
      return 0;
  }
  return 0;
}

std::uint64_t output_bytes(const PlanStep& step) {
  std::uint64_t bytes = 0;
  for (const Port& port : step.declaration->outputs) {
    const auto found = step.outputs.find(port.name);
    if (found != step.outputs.end()) bytes += forecast_bytes(port.kind, found->second);
  }
  return bytes;
}

// The largest sum of a step's own peak and the results that later steps, or later rounds, still need.
std::uint64_t peak_of(const Plan& plan) {
  const std::vector<PlanStep>& steps = plan.steps;
  std::vector<std::size_t> last_use(steps.size());
  for (std::size_t i = 0; i < steps.size(); ++i) {
    last_use[i] = std::max(last_use[i], i);
    for (const PlanInput& input : steps[i].inputs) {
      const bool is_kept = plan.max_rounds() > 1 && !steps[input.step].repeats && steps[i].repeats;
      last_use[input.step] = std::max(last_use[input.step], is_kept ? steps.size() : i);
    }
  }
  std::uint64_t peak = 0;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    std::uint64_t alive = steps[i].peak_bytes;
    for (std::size_t j = 0; j < i; ++j) alive += last_use[j] >= i ? output_bytes(steps[j]) : 0;
    peak = std::max(peak, alive);
  }
  return peak;
}

// Marks what feedback runs again: the steps that take hints, and all that use their results.
void mark_repeats(std::vector<PlanStep>& steps) {
  for (PlanStep& step : steps) {
    if (step.declaration == nullptr) continue;
    for (const Port& port : step.declaration->inputs) {
      if (port.kind == ArtefactKind::kHints) step.hints_port = port.name;
    }
    for (const Port& port : step.declaration->outputs) {
      step.gives_hints = step.gives_hints || port.kind == ArtefactKind::kHints;
    }
    step.repeats = !step.hints_port.empty() ||
                   std::any_of(step.inputs.begin(), step.inputs.end(),
                               [&](const PlanInput& input) { return steps[input.step].repeats; });
  }
}

void check_feedback(const Plan& plan, const SourcePlace& place, Diagnostics& diagnostics) {
  const auto any = [&](auto property) { return std::any_of(plan.steps.begin(), plan.steps.end(), property); };
  if (!any([](const PlanStep& step) { return step.gives_hints; })) {
    diagnostics.push_back({Severity::kError,
                           "plan.no_hints",
                           {},
                           "feedback",
                           place,
                           "key 'feedback': no stage of the chain judges, so no round can pass",
                           "add a stage that gives hints ('periost stages' lists them) or leave it out"});
  } else if (!any([](const PlanStep& step) { return !step.hints_port.empty() && !step.gives_hints; })) {
    diagnostics.push_back({Severity::kWarning,
                           "plan.no_hints",
                           {},
                           "feedback",
                           place,
                           "key 'feedback': no stage of the chain takes hints, so every round gives the same",
                           {}});
  }
}

Value entry_of(const PlanStep& step, const Plan& plan, const std::filesystem::path& folder) {
  Value entry = Value::map({{"stage", {}, Value::scalar(step.kind)}, {"id", {}, Value::scalar(step.id)}});
  Value from = Value::map({});
  for (const PlanInput& input : step.inputs) {
    const PlanStep& producer = plan.steps[input.step];
    const std::string& output = producer.declaration->outputs[input.output].name;
    const bool is_only = producer.declaration->outputs.size() == 1;
    from.entries.push_back(
        {input.port, {}, Value::scalar(is_only ? producer.id : producer.id + "." + output)});
  }
  if (!from.entries.empty()) entry.entries.push_back({"from", {}, std::move(from)});
  Value params = step.declaration->params->encode(step.options, folder);
  for (Value::Entry& e : params.entries) entry.entries.push_back(std::move(e));
  return entry;
}

// The files of plugins that the steps need, however they were found: the resolved configuration names them
// all.
void add_used_plugins(Plan& plan, const Registry& registry) {
  for (const PlanStep& step : plan.steps) {
    const Registry::Entry* entry = registry.find(step.kind);
    if (entry == nullptr || entry->origin == Registry().origin()) continue;
    const std::filesystem::path file = entry->origin;
    if (std::find(plan.plugins.begin(), plan.plugins.end(), file) == plan.plugins.end())
      plan.plugins.push_back(file);
  }
}

std::string_view name_of(Provenance::Paths paths) {
  return paths == Provenance::Paths::kFull ? "full" : paths == Provenance::Paths::kNone ? "none" : "basename";
}

// The order of the file; what has the same place stays in the order it came.
void sort_by_place(Diagnostics& diagnostics) {
  const auto is_before = [](const Diagnostic& a, const Diagnostic& b) {
    if (a.place.file != b.place.file) return a.place.file < b.place.file;
    return std::pair(a.place.line, a.place.column) < std::pair(b.place.line, b.place.column);
  };
  std::stable_sort(diagnostics.begin(), diagnostics.end(), is_before);
}

Value quoted(std::string text) {
  Value value = Value::scalar(std::move(text));
  value.is_quoted = true;
  return value;
}

}  // namespace

Plan make_plan(const Configuration& configuration, const Registry& registry, Diagnostics& diagnostics) {
  Plan plan{configuration.name,    configuration.seed, configuration.provenance, configuration.plugins, {}, 0,
            configuration.feedback};
  const std::size_t before = diagnostics.size();
  for (const StageEntry& entry : configuration.chain) {
    plan.steps.push_back(make_step(entry, configuration, registry, plan.steps, diagnostics));
  }
  const bool is_complete =
      std::none_of(diagnostics.begin() + static_cast<std::ptrdiff_t>(before), diagnostics.end(),
                   [](const Diagnostic& d) { return d.severity == Severity::kError; });
  const bool is_known = std::all_of(plan.steps.begin(), plan.steps.end(),
                                    [](const PlanStep& step) { return step.declaration != nullptr; });
  if (plan.feedback) {
    mark_repeats(plan.steps);
    if (is_known) check_feedback(plan, configuration.feedback_place, diagnostics);
  }
  if (is_complete && is_known) plan.peak_bytes = peak_of(plan);
  add_used_plugins(plan, registry);
  sort_by_place(diagnostics);
  return plan;
}

Value resolved_configuration(const Plan& plan, const std::filesystem::path& folder) {
  Value chain = Value::list({});
  for (const PlanStep& step : plan.steps) chain.items.push_back(entry_of(step, plan, folder));
  Value plugins = Value::list({});
  for (const std::filesystem::path& plugin : plan.plugins) {
    plugins.items.push_back(
        quoted((folder.empty() ? plugin : plugin.lexically_proximate(folder)).generic_string()));
  }
  Value provenance =
      Value::map({{"dicom_uids", {}, Value::scalar(plan.provenance.dicom_uids ? "true" : "false")},
                  {"paths", {}, Value::scalar(std::string(name_of(plan.provenance.paths)))}});
  Value document = Value::map({{"periost", {}, Value::scalar("1")},
                               {"name", {}, quoted(plan.name)},
                               {"seed", {}, Value::scalar(std::to_string(plan.seed))},
                               {"plugins", {}, std::move(plugins)},
                               {"provenance", {}, std::move(provenance)},
                               {"chain", {}, std::move(chain)}});
  if (plan.feedback) {
    Value feedback = Value::map({});
    feedback.entries.push_back({"until", {}, Value::scalar(plan.feedback->until)});
    feedback.entries.push_back({"max_rounds", {}, Value::scalar(std::to_string(plan.feedback->max_rounds))});
    document.entries.push_back({"feedback", {}, std::move(feedback)});
  }
  return document;
}

std::vector<UnrolledStep> unrolled(const Plan& plan) {
  std::vector<UnrolledStep> all;
  for (std::uint32_t round = 1; round <= plan.max_rounds(); ++round) {
    for (std::size_t step = 0; step < plan.steps.size(); ++step) {
      if (round == 1 || plan.steps[step].repeats) all.push_back({round, step});
    }
  }
  return all;
}

}  // namespace periost
