// periost stages: the stages and their parameters, from their declarations.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <nlohmann/json.hpp>

#include "pipeline/app/commands.h"
#include "pipeline/app/load_stages.h"
#include "pipeline/base/error.h"
#include "pipeline/param/render.h"

namespace periost {
namespace {

using Json = nlohmann::ordered_json;

struct StagesOptions {
  std::string name;
  std::string format = "text";
};

std::string properties_text(const SurfaceProperties& properties) {
  std::string text;
  if (properties.closed) text += ", closed";
  if (properties.manifold) text += ", manifold";
  if (properties.oriented) text += ", oriented";
  return text;
}

std::string port_text(const Port& port) {
  return fmt::format("{}: {}{}{}", port.name, name_of(port.kind), properties_text(port.properties),
                     port.by_name    ? ", only by from"
                     : port.optional ? ", optional"
                                     : "");
}

std::string ports_text(const char* title, const std::vector<Port>& ports) {
  std::string text;
  for (const Port& port : ports) text += fmt::format("  {} {}\n      {}\n", title, port_text(port), port.doc);
  return text;
}

std::string text_of(const Registry::Entry& entry) {
  const StageDeclaration& d = entry.declaration;
  std::string text = fmt::format("{} (version {}, {})\n  {}\n\n", d.name, d.version, entry.origin, d.summary);
  text += ports_text("input", d.inputs) + ports_text("output", d.outputs);
  const std::string help = help_text(d.params->params());
  if (!help.empty()) text += "\n" + help;
  return text;
}

std::string markdown_of(const Registry::Entry& entry) {
  const StageDeclaration& d = entry.declaration;
  std::string text = fmt::format("## {}\n\n{}\n\n", d.name, d.summary);
  for (const Port& port : d.inputs) text += fmt::format("- input `{}`. {}\n", port_text(port), port.doc);
  for (const Port& port : d.outputs) text += fmt::format("- output `{}`. {}\n", port_text(port), port.doc);
  if (!d.inputs.empty() || !d.outputs.empty()) text += "\n";
  const std::string table = markdown_table(d.params->params());
  return text + (table.empty() ? "" : table + "\n");
}

Json json_of(const std::vector<Port>& ports) {
  Json list = Json::array();
  for (const Port& port : ports) {
    list.push_back({{"name", port.name},
                    {"kind", name_of(port.kind)},
                    {"optional", port.optional},
                    {"only_by_from", port.by_name},
                    {"closed", port.properties.closed},
                    {"manifold", port.properties.manifold},
                    {"oriented", port.properties.oriented},
                    {"doc", port.doc}});
  }
  return list;
}

Json json_of(const Registry::Entry& entry) {
  const StageDeclaration& d = entry.declaration;
  return {{"name", d.name},
          {"version", d.version},
          {"summary", d.summary},
          {"origin", entry.origin},
          {"inputs", json_of(d.inputs)},
          {"outputs", json_of(d.outputs)},
          {"params", Json::parse(json_list(d.params->params()))}};
}

// One line a stage.
std::string overview(const Registry& registry) {
  std::size_t width = 0;
  for (const std::string& name : registry.names()) width = std::max(width, name.size());
  std::string text;
  for (const std::string& name : registry.names()) {
    text += fmt::format("{:<{}}  {}\n", name, width, registry.find(name)->declaration.summary);
  }
  return text;
}

std::vector<std::string> chosen_names(const Registry& registry, const std::string& name) {
  if (name.empty()) return registry.names();
  if (registry.find(name) != nullptr) return {name};
  const std::string near = registry.nearest(name);
  throw Error(ErrorKind::kUsage, "config.unknown_stage", fmt::format("unknown stage '{}'", name),
              near.empty() ? "'periost stages' lists them" : fmt::format("did you mean '{}'?", near));
}

int list_stages(const StagesOptions& options) {
  Registry registry;
  Diagnostics diagnostics;
  load_stages(registry, {}, diagnostics);
  for (const Diagnostic& diagnostic : diagnostics) fmt::print(stderr, "{}\n", format(diagnostic));
  const std::vector<std::string> names = chosen_names(registry, options.name);
  if (options.format == "json") {
    Json list = Json::array();
    for (const std::string& name : names) list.push_back(json_of(*registry.find(name)));
    fmt::print("{}\n", (options.name.empty() ? list : list.front()).dump(2));
  } else if (options.format == "markdown") {
    if (options.name.empty()) fmt::print("# Stages\n\n");
    for (const std::string& name : names) fmt::print("{}", markdown_of(*registry.find(name)));
  } else {
    fmt::print("{}", options.name.empty() ? overview(registry) : text_of(*registry.find(names.front())));
  }
  return has_errors(diagnostics) ? exit_code(ErrorKind::kUsage) : 0;
}

}  // namespace

void add_stages_command(CLI::App& app, Session& session) {
  auto options = std::make_shared<StagesOptions>();
  CLI::App* command = add_command(app, "stages", "Lists the stages, or one stage's parameters.",
                                  "periost stages decimate --format markdown");
  command->add_option("NAME", options->name, "Only this stage.");
  command->add_option("--format", options->format, "text, json or markdown.")
      ->check(CLI::IsMember({"text", "json", "markdown"}));
  command->callback([options, &session] { session.exit_code = list_stages(*options); });
}

}  // namespace periost
