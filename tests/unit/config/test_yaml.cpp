#include <gmock/gmock.h>

#include "pipeline/config/emit.h"
#include "pipeline/config/environment.h"
#include "pipeline/config/yaml_document.h"

namespace periost {
namespace {

Value parse(const std::string& text) {
  Diagnostics diagnostics;
  Value value = parse_yaml(text, "f.yaml", diagnostics);
  for (const Diagnostic& diagnostic : diagnostics) ADD_FAILURE() << format(diagnostic);
  return value;
}

bool same(const Value& a, const Value& b) {
  const auto same_entry = [](const Value::Entry& x, const Value::Entry& y) {
    return x.key == y.key && same(x.value, y.value);
  };
  return a.kind == b.kind && a.text == b.text && a.is_quoted == b.is_quoted &&
         std::equal(a.items.begin(), a.items.end(), b.items.begin(), b.items.end(), same) &&
         std::equal(a.entries.begin(), a.entries.end(), b.entries.begin(), b.entries.end(), same_entry);
}

TEST(Yaml, KeepsTextsAndPlaces) {
  const Value value = parse("a: 010\nb:\n  - yes\n  - 'x'\nc: {d: 0.3 voxel}\n");
  EXPECT_EQ(value.find("a")->text, "010");
  EXPECT_EQ(value.find("a")->place.line, 1);
  EXPECT_EQ(value.find("a")->place.column, 4);
  EXPECT_EQ(value.find("b")->items.at(0).text, "yes");
  EXPECT_FALSE(value.find("b")->items.at(0).is_quoted);
  EXPECT_TRUE(value.find("b")->items.at(1).is_quoted);
  EXPECT_EQ(value.find("c")->find("d")->text, "0.3 voxel");
  EXPECT_EQ(value.find("c")->find("d")->place.column, 8);
  EXPECT_EQ(value.entries.at(2).place.line, 5);
}

TEST(Yaml, WindowsLinesAndComments) {
  EXPECT_EQ(parse("# head\r\na: b\r\n").find("a")->text, "b");
}

TEST(Yaml, EmittedTextReadsBack) {
  const Value value = parse(
      "a: 1\nq: \"1\"\nempty: ''\nnothing: ~\nword: 'null'\nlist: [1, two, 'three, four']\nnested: [[1, 2], "
      "[3]]\n"
      "maps:\n  - x: 1\n    y: {z: 'a: b'}\n  - {}\nflow: []\n'odd: key': '- #'\ntext: "
      "\"line\\nline\\ttab\\\"\\\\ é\"\n"
      "dash: -1\nhash: a#b\ncolon: a:b\nstar: '*x'\nspaced: ' a '\nq2: 'true'\ndollar: '$${X} $$'\n");
  const std::string text = emit_yaml(value);
  Value back = parse(text);
  Diagnostics diagnostics;
  expand_environment(
      back, [](const std::string&) { return std::nullopt; }, diagnostics);
  EXPECT_TRUE(same(value, back)) << text;
  EXPECT_EQ(emit_yaml(back), text);
}

TEST(Yaml, EmitsEveryByteOfAText) {
  for (int c = 1; c < 128; ++c) {
    for (const char* pattern : {"%", "%a", "a%", "a%b", "a %", "% b"}) {
      std::string text = pattern;
      text.replace(text.find('%'), 1, 1, static_cast<char>(c));
      Value value = Value::map({{"k", {}, Value::list({Value::scalar(text)})}});
      const Value back = parse(emit_yaml(value));
      ASSERT_EQ(back.kind, Value::Kind::kMap) << emit_yaml(value);
      EXPECT_EQ(back.find("k")->items.at(0).text, text) << c << " " << pattern;
    }
  }
}

TEST(Environment, ExpandsOnceAndEscapes) {
  const Environment environment = [](const std::string& name) -> std::optional<std::string> {
    return name == "A" ? std::optional<std::string>("${B}") : std::nullopt;
  };
  Value value = parse("x:\n- ${A}/y\n- $${A}\n- $A\n- 'a$'\n- $$\n");
  Diagnostics diagnostics;
  expand_environment(value, environment, diagnostics);
  EXPECT_TRUE(diagnostics.empty());
  const std::vector<Value>& items = value.find("x")->items;
  EXPECT_EQ(items.at(0).text, "${B}/y");
  EXPECT_EQ(items.at(1).text, "${A}");
  EXPECT_EQ(items.at(2).text, "$A");
  EXPECT_EQ(items.at(3).text, "a$");
  EXPECT_EQ(items.at(4).text, "$$");
}

}  // namespace
}  // namespace periost
