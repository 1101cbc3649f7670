#include "pipeline/stage/registry.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "pipeline/base/error.h"

namespace periost {
namespace {

bool is_snake_case(const std::string& name) {
  const auto is_allowed = [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_'; };
  return !name.empty() && name[0] >= 'a' && name[0] <= 'z' &&
         std::all_of(name.begin(), name.end(), is_allowed);
}

[[noreturn]] void reject(const StageDeclaration& declaration, const std::string& reason) {
  throw Error(ErrorKind::kUsage, "plugin.bad_declaration",
              fmt::format("stage '{}' is not declared well: {}", declaration.name, reason));
}

void check_names(const StageDeclaration& declaration, const std::vector<std::string>& names,
                 const char* what) {
  std::set<std::string> seen;
  for (const std::string& name : names) {
    if (!is_snake_case(name)) reject(declaration, fmt::format("{} '{}' is not snake_case", what, name));
    if (!seen.insert(name).second) reject(declaration, fmt::format("{} '{}' is declared twice", what, name));
  }
}

void check_ports(const StageDeclaration& declaration, const std::vector<Port>& ports, const char* what) {
  std::vector<std::string> names;
  for (const Port& port : ports) {
    names.push_back(port.name);
    if (port.doc.empty()) reject(declaration, fmt::format("{} '{}' has no sentence", what, port.name));
  }
  check_names(declaration, names, what);
}

void check_params(const StageDeclaration& declaration, const std::vector<ParamInfo>& params) {
  std::vector<std::string> names;
  for (const ParamInfo& param : params) {
    names.push_back(param.name);
    if (param.doc.empty()) reject(declaration, fmt::format("key '{}' has no sentence", param.name));
    if (param.name == "stage" || param.name == "id" || param.name == "from") {
      reject(declaration, fmt::format("the key '{}' is the framework's own", param.name));
    }
    if (param.type.fields) check_params(declaration, *param.type.fields);
  }
  check_names(declaration, names, "key");
}

// Whatever Options{} holds must be writable and readable again, ranges included.
void check_defaults(const StageDeclaration& declaration) {
  Value map = declaration.params->encode(declaration.params->defaults());
  std::erase_if(map.entries, [&](const Value::Entry& entry) {
    const auto& params = declaration.params->params();
    return std::any_of(params.begin(), params.end(), [&](const ParamInfo& param) {
      return param.name == entry.key && param.range.is_required;
    });
  });
  Diagnostics diagnostics;
  declaration.params->decode(map, diagnostics);
  for (const Diagnostic& diagnostic : diagnostics) {
    if (diagnostic.code != "config.missing_key") reject(declaration, "of its defaults, " + diagnostic.text);
  }
}

void check(const StageDeclaration& declaration) {
  check_names(declaration, {declaration.name}, "its name");
  if (declaration.summary.empty()) reject(declaration, "it has no sentence");
  check_ports(declaration, declaration.inputs, "input");
  check_ports(declaration, declaration.outputs, "output");
  check_params(declaration, declaration.params->params());
  check_defaults(declaration);
}

[[noreturn]] void reject_duplicate(const std::string& name, const std::string& first,
                                   const std::string& second) {
  throw Error(ErrorKind::kUsage, "plugin.duplicate_stage",
              fmt::format("stage '{}' is registered twice: first {}, then {}", name, first, second),
              "rename one of them");
}

}  // namespace

void Registry::add(std::unique_ptr<const Stage> stage) {
  StageDeclaration declaration = stage->declaration();
  check(declaration);
  const auto found = entries_.find(declaration.name);
  if (found != entries_.end()) reject_duplicate(declaration.name, found->second.origin, origin_);
  const std::string name = declaration.name;
  entries_.emplace(name, Entry{std::move(stage), std::move(declaration), origin_});
}

const Registry::Entry* Registry::find(const std::string& name) const {
  const auto found = entries_.find(name);
  return found == entries_.end() ? nullptr : &found->second;
}

std::vector<std::string> Registry::names() const {
  std::vector<std::string> names;
  for (const auto& [name, entry] : entries_) names.push_back(name);
  return names;
}

std::string Registry::nearest(const std::string& name) const {
  return nearest_name(name, names());
}

void Registry::merge(Registry&& other) {
  for (const auto& [name, entry] : other.entries_) {
    const auto found = entries_.find(name);
    if (found != entries_.end()) reject_duplicate(name, found->second.origin, entry.origin);
  }
  entries_.merge(other.entries_);
}

void register_stage(Registry& registry, std::unique_ptr<Stage> stage) {
  registry.add(std::move(stage));
}

}  // namespace periost
