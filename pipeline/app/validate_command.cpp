// periost validate: checks a configuration as far as that is possible without reading data.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "pipeline/app/commands.h"
#include "pipeline/app/load_stages.h"
#include "pipeline/base/error.h"
#include "pipeline/run/plan.h"
#include "pipeline/run/summary.h"

namespace periost {
namespace {

using Json = nlohmann::ordered_json;

struct ValidateOptions {
  std::string configuration;
  std::vector<std::string> overrides;
  std::string format = "text";
};

const char* name_of(Severity severity) {
  return severity == Severity::kError ? "error" : severity == Severity::kWarning ? "warning" : "note";
}

Json json_of(const Diagnostic& diagnostic) {
  return {{"severity", name_of(diagnostic.severity)},
          {"code", diagnostic.code},
          {"stage", diagnostic.stage},
          {"key", diagnostic.key},
          {"file", diagnostic.place.file},
          {"line", diagnostic.place.line},
          {"column", diagnostic.place.column},
          {"text", diagnostic.text},
          {"hint", diagnostic.hint}};
}

Json json_of(const Plan& plan) {
  Json steps = Json::array();
  for (const PlanStep& step : plan.steps) {
    Json inputs = Json::object();
    for (const PlanInput& input : step.inputs) inputs[input.port] = plan.steps[input.step].id;
    steps.push_back({{"id", step.id},
                     {"kind", step.kind},
                     {"inputs", inputs},
                     {"peak_bytes", step.peak_bytes},
                     {"repeats", step.repeats}});
  }
  return {{"name", plan.name},
          {"stages", steps},
          {"peak_bytes", plan.peak_bytes},
          {"max_rounds", plan.max_rounds()}};
}

std::string text_of(const Plan& plan) {
  std::string text;
  for (const PlanStep& step : plan.steps) {
    std::string inputs;
    for (const PlanInput& input : step.inputs) {
      inputs +=
          fmt::format("{}{} from {}", inputs.empty() ? " <- " : ", ", input.port, plan.steps[input.step].id);
    }
    text += fmt::format("  {}{}{}\n", step.id, step.id == step.kind ? "" : " (" + step.kind + ")", inputs);
  }
  text += rounds_text(plan);
  if (plan.peak_bytes > 0) {
    text += fmt::format("about {:.1f} GiB of memory\n", static_cast<double>(plan.peak_bytes) / (1u << 30));
  }
  return text;
}

void print_json(const Plan& plan, const Diagnostics& diagnostics) {
  const bool is_valid = !has_errors(diagnostics);
  Json json = {{"valid", is_valid}, {"diagnostics", Json::array()}};
  for (const Diagnostic& diagnostic : diagnostics) json["diagnostics"].push_back(json_of(diagnostic));
  if (is_valid) json["plan"] = json_of(plan);
  fmt::print("{}\n", json.dump(2, ' ', false, Json::error_handler_t::replace));
}

int validate(const ValidateOptions& options) {
  Diagnostics diagnostics;
  const Configuration configuration =
      read_configuration(options.configuration, options.overrides, diagnostics);
  Registry registry;
  load_stages(registry, configuration, diagnostics);
  const Plan plan = make_plan(configuration, registry, diagnostics);
  const bool is_valid = !has_errors(diagnostics);
  if (options.format == "json") {
    print_json(plan, diagnostics);
  } else {
    for (const Diagnostic& diagnostic : diagnostics) fmt::print(stderr, "{}\n", format(diagnostic));
    if (is_valid) fmt::print("{}: valid\n{}", options.configuration, text_of(plan));
  }
  return is_valid ? 0 : exit_code(ErrorKind::kUsage);
}

}  // namespace

void add_validate_command(CLI::App& app, Session& session) {
  auto options = std::make_shared<ValidateOptions>();
  CLI::App* command = add_command(app, "validate", "Checks a configuration without reading data.",
                                  "periost validate cranium.yaml --set decimate.distance=0.3voxel");
  command->add_option("CONFIG", options->configuration, "The configuration file.")->required();
  command->add_option("--set", options->overrides, "KEY=VALUE: sets a key, by a stage's id or kind.")
      ->allow_extra_args(false);
  command->add_option("--format", options->format, "text or json.")->check(CLI::IsMember({"text", "json"}));
  command->callback([options, &session] { session.exit_code = validate(*options); });
}

}  // namespace periost
