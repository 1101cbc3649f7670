#include "pipeline/run/schema.h"

#include <nlohmann/json.hpp>

#include "pipeline/config/configuration.h"
#include "pipeline/param/render.h"

namespace periost {
namespace {

using Json = nlohmann::ordered_json;

// `from:` takes an id, a list of ids, or a map from input to id.
Json from_schema() {
  const Json id = {{"type", "string"}};
  return {{"description", "The stages whose results this one takes, instead of the newest."},
          {"anyOf", Json::array({id, Json{{"type", "array"}, {"items", id}},
                                 Json{{"type", "object"}, {"additionalProperties", id}}})}};
}

Json stage_schema(const StageDeclaration& declaration) {
  Json schema = Json::parse(json_schema(declaration.params->params()));
  schema["description"] = declaration.summary;
  schema["properties"]["stage"] = {{"const", declaration.name}, {"description", declaration.summary}};
  schema["properties"]["id"] = {{"type", "string"},
                                {"pattern", "^[A-Za-z0-9_-]+$"},
                                {"description", "Name of this stage, for `from` and --set."}};
  schema["properties"]["from"] = from_schema();
  schema["required"].push_back("stage");
  return schema;
}

// One branch a stage, chosen by `stage`: an error then speaks of this stage alone.
Json entry_schema(const Registry& registry) {
  Json names = Json::array();
  Json branches = Json::array();
  for (const std::string& name : registry.names()) {
    names.push_back(name);
    branches.push_back({{"if", {{"properties", {{"stage", {{"const", name}}}}}, {"required", {"stage"}}}},
                        {"then", {{"$ref", "#/$defs/" + name}}}});
  }
  Json schema = {{"type", "object"},
                 {"properties", {{"stage", {{"enum", names}}}}},
                 {"required", Json::array({"stage"})}};
  if (!branches.empty()) schema["allOf"] = branches;
  return schema;
}

}  // namespace

std::string configuration_schema(const Registry& registry) {
  Json schema = {{"$schema", "https://json-schema.org/draft/2020-12/schema"},
                 {"$id", "https://periost.invalid/configuration/1"},
                 {"title", "Periost configuration"}};
  schema.update(Json::parse(json_schema(top_level_params())));
  schema["properties"]["chain"] = {{"description", "The stages, in order."},
                                   {"type", "array"},
                                   {"minItems", 1},
                                   {"items", entry_schema(registry)}};
  schema["$defs"] = Json::object();
  for (const std::string& name : registry.names()) {
    schema["$defs"][name] = stage_schema(registry.find(name)->declaration);
  }
  return schema.dump(2);
}

}  // namespace periost
