// What must hold of every stage that is linked in, and of the schema and the documentation made of them.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "pipeline/config/emit.h"
#include "pipeline/config/yaml_document.h"
#include "pipeline/param/render.h"
#include "pipeline/run/schema.h"
#include "pipeline/stage/registry.h"

namespace periost {

void register_builtin_stages(Registry& registry);

namespace {

class BuiltinStages : public testing::Test {
 protected:
  BuiltinStages() { register_builtin_stages(registry_); }
  Registry registry_;
};

void expect_documented(const std::string& stage, const std::vector<ParamInfo>& params) {
  for (const ParamInfo& param : params) {
    EXPECT_GT(param.doc.size(), 10u) << stage << "." << param.name;
    EXPECT_TRUE(param.doc.ends_with(".") || param.doc.ends_with("?")) << stage << "." << param.name;
    for (const ChoiceInfo& choice : param.type.choices)
      EXPECT_NE(choice.doc, "") << stage << "." << param.name;
    if (param.type.fields) expect_documented(stage + "." + param.name, *param.type.fields);
  }
}

TEST_F(BuiltinStages, SayWhatTheyAre) {
  for (const std::string& name : registry_.names()) {
    const StageDeclaration& d = registry_.find(name)->declaration;
    EXPECT_TRUE(d.summary.ends_with(".")) << name;
    EXPECT_GE(d.version, 1u) << name;
    expect_documented(name, d.params->params());
  }
}

// The defaults, written as YAML and read again, are the defaults: required keys, which have none, aside.
TEST_F(BuiltinStages, DefaultsSurviveTheFile) {
  for (const std::string& name : registry_.names()) {
    const ParamTableBase& params = *registry_.find(name)->declaration.params;
    const std::string text = emit_yaml(params.encode(params.defaults()));
    Diagnostics diagnostics;
    const Value document = parse_yaml(text, name, diagnostics);
    const std::any options = params.decode(document, diagnostics);
    for (const Diagnostic& d : diagnostics) EXPECT_EQ(d.code, "config.missing_key") << format(d);
    EXPECT_EQ(emit_yaml(params.encode(options)), text) << name;
  }
}

TEST_F(BuiltinStages, HaveASchemaThatRefersToNothingMissing) {
  const auto schema = nlohmann::json::parse(configuration_schema(registry_));
  EXPECT_EQ(schema["$schema"], "https://json-schema.org/draft/2020-12/schema");
  for (const std::string& name : registry_.names()) {
    const auto& stage = schema["$defs"].at(name);
    EXPECT_EQ(stage["properties"]["stage"]["const"], name);
    for (const ParamInfo& param : registry_.find(name)->declaration.params->params()) {
      EXPECT_TRUE(stage["properties"].contains(param.name)) << name << "." << param.name;
    }
  }
  const auto& branches = schema["properties"]["chain"]["items"]["allOf"];
  EXPECT_EQ(branches.size(), registry_.names().size());
  for (const auto& branch : branches) {
    const std::string reference = branch["then"]["$ref"];
    EXPECT_TRUE(schema["$defs"].contains(reference.substr(std::string("#/$defs/").size()))) << reference;
  }
}

}  // namespace
}  // namespace periost
