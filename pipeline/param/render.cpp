#include "pipeline/param/render.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>

namespace periost {
namespace {

using Json = nlohmann::ordered_json;
using TypeKind = TypeInfo::Kind;

std::string quoted(const std::string& text) {
  return Json(text).dump();
}

std::string unit_words(Quantity quantity) {
  switch (quantity) {
    case Quantity::kLength:
      return " (mm)";
    case Quantity::kAngle:
      return " (deg)";
    case Quantity::kIntensity:
      return " (unit of the image, HU)";
    case Quantity::kVolume:
      return " (mm3)";
    case Quantity::kSeconds:
      return " (s)";
    default:
      return {};
  }
}

std::string choice_words(const TypeInfo& type) {
  std::vector<std::string> names;
  for (const ChoiceInfo& choice : type.choices) names.push_back(choice.name);
  return fmt::format("{}", fmt::join(names, " | "));
}

std::string words_of(const TypeInfo& type, Quantity quantity) {
  switch (type.kind) {
    case TypeKind::kSwitch:
      return "true | false";
    case TypeKind::kInteger:
      return "whole number";
    case TypeKind::kNumber:
      return "number" + unit_words(quantity);
    case TypeKind::kText:
      return "text";
    case TypeKind::kPath:
      return "path";
    case TypeKind::kLength:
      return "length (mm or voxel)";
    case TypeKind::kAngle:
      return "angle (deg)";
    case TypeKind::kSize:
      return "size (4GiB, 500MB)";
    case TypeKind::kChoice:
      return choice_words(type);
    case TypeKind::kForm:
      return type.form;
    case TypeKind::kList:
      return "list of " + words_of(*type.element, quantity);
    case TypeKind::kArray:
      return fmt::format("{} x {}", type.count, words_of(*type.element, quantity));
    case TypeKind::kGroup:
      return "group";
    case TypeKind::kMap:
      return "map of name to " + words_of(*type.element, quantity);
  }
  return {};
}

// The keys below a parameter: of the group itself, or of what a list or map holds.
const std::vector<ParamInfo>* nested_params(const TypeInfo& type) {
  if (type.kind == TypeKind::kGroup) return type.fields.get();
  return type.element ? nested_params(*type.element) : nullptr;
}

std::string nested_prefix(const ParamInfo& param) {
  switch (param.type.kind) {
    case TypeKind::kMap:
      return param.name + ".NAME.";
    case TypeKind::kList:
      return param.name + "[N].";
    default:
      return param.name + ".";
  }
}

std::string default_text(const ParamInfo& param) {
  return param.range.is_required ? "required" : flow_text(param.default_value);
}

void add_bounds(Json& schema, const Range& range) {
  if (std::isfinite(range.min)) schema[range.min_excluded ? "exclusiveMinimum" : "minimum"] = range.min;
  if (std::isfinite(range.max)) schema[range.max_excluded ? "exclusiveMaximum" : "maximum"] = range.max;
}

// A number, or a text of a number and one of the units.
Json number_with_units(const Range& range, std::string_view units, bool takes_bare) {
  Json text = {{"type", "string"},
               {"pattern", fmt::format("^[-+]?([0-9]+\\.?[0-9]*|\\.[0-9]+)([eE][-+]?[0-9]+)? ?({}){}$", units,
                                       takes_bare ? "?" : "")}};
  if (!takes_bare) return text;
  Json number = {{"type", "number"}};
  add_bounds(number, range);
  return {{"anyOf", Json::array({number, text})}};
}

std::string_view unit_pattern(Quantity quantity) {
  switch (quantity) {
    case Quantity::kLength:
      return "mm|um|cm|m";
    case Quantity::kAngle:
      return "deg|rad";
    case Quantity::kIntensity:
      return "HU";
    case Quantity::kVolume:
      return "mm3|mm\\^3|cm3|cm\\^3|ml";
    case Quantity::kSeconds:
      return "s|ms|min|h";
    default:
      return {};
  }
}

Json object_schema(const std::vector<ParamInfo>& params);

Json whole_number(const TypeInfo& type, const Range& range) {
  Json schema = {{"type", "integer"}};
  add_bounds(schema, range);
  if (!schema.contains("minimum") && !schema.contains("exclusiveMinimum")) schema["minimum"] = type.least;
  return schema;
}

Json choice_schema(const TypeInfo& type) {
  Json schema = {{"enum", Json::array()}};
  for (const ChoiceInfo& choice : type.choices) schema["enum"].push_back(choice.name);
  return schema;
}

Json type_schema(const TypeInfo& type, const ParamInfo& param) {
  switch (type.kind) {
    case TypeKind::kSwitch:
      return {{"type", "boolean"}};
    case TypeKind::kInteger:
      return whole_number(type, param.range);
    case TypeKind::kNumber: {
      const std::string_view units = unit_pattern(param.quantity);
      if (!units.empty()) return number_with_units(param.range, units, true);
      Json schema = {{"type", "number"}};
      add_bounds(schema, param.range);
      return schema;
    }
    case TypeKind::kText:
    case TypeKind::kForm:
      return {{"type", Json::array({"string", "number", "boolean"})}};
    case TypeKind::kPath:
      return {{"type", "string"}};
    case TypeKind::kLength:
      return number_with_units(param.range, "mm|um|cm|m|voxels?", true);
    case TypeKind::kAngle:
      return number_with_units(param.range, "deg|rad", true);
    case TypeKind::kSize:
      return number_with_units(param.range, "[kMGT]?B|[KMGT]iB", false);
    case TypeKind::kChoice:
      return choice_schema(type);
    case TypeKind::kList: {
      const Json item = type_schema(*type.element, param);
      return {{"anyOf", Json::array({Json{{"type", "array"}, {"items", item}}, item})}};
    }
    case TypeKind::kArray:
      return {{"type", "array"},
              {"items", type_schema(*type.element, param)},
              {"minItems", type.count},
              {"maxItems", type.count}};
    case TypeKind::kGroup:
      return object_schema(*type.fields);
    case TypeKind::kMap:
      return {{"type", "object"}, {"additionalProperties", type_schema(*type.element, param)}};
  }
  return {};
}

Json param_schema(const ParamInfo& param) {
  Json schema = {{"description", param.doc}};
  Json form = type_schema(param.type, param);
  if (param.type.is_optional) form = {{"anyOf", Json::array({form, Json{{"type", "null"}}})}};
  schema.update(form);
  if (!param.range.is_required) schema["description"] = param.doc + " Default: " + default_text(param) + ".";
  return schema;
}

Json object_schema(const std::vector<ParamInfo>& params) {
  Json schema = {{"type", "object"}, {"properties", Json::object()}, {"additionalProperties", false}};
  Json required = Json::array();
  for (const ParamInfo& param : params) {
    schema["properties"][param.name] = param_schema(param);
    if (param.range.is_required) required.push_back(param.name);
  }
  if (!required.empty()) schema["required"] = required;
  return schema;
}

Json param_list(const std::vector<ParamInfo>& params) {
  Json list = Json::array();
  for (const ParamInfo& param : params) {
    Json item = {{"name", param.name},
                 {"type", type_text(param)},
                 {"required", param.range.is_required},
                 {"range", param.range.text()},
                 {"doc", param.doc}};
    if (!param.range.is_required) item["default"] = flow_text(param.default_value);
    for (const ChoiceInfo& choice : param.type.choices) {
      item["choices"].push_back({{"name", choice.name}, {"doc", choice.doc}});
    }
    if (const auto* nested = nested_params(param.type)) item["params"] = param_list(*nested);
    list.push_back(item);
  }
  return list;
}

void add_help(std::string& text, const std::vector<ParamInfo>& params, const std::string& indent) {
  for (const ParamInfo& param : params) {
    text += fmt::format("{}{}: {}", indent, param.name, type_text(param));
    const auto* nested = nested_params(param.type);
    if (nested == nullptr || param.range.is_required) text += fmt::format("  [{}]", default_text(param));
    if (!param.range.text().empty()) text += ", " + param.range.text();
    text += fmt::format("\n{}    {}\n", indent, param.doc);
    for (const ChoiceInfo& choice : param.type.choices) {
      text += fmt::format("{}    {}: {}\n", indent, choice.name, choice.doc);
    }
    if (nested != nullptr) add_help(text, *nested, indent + "    ");
  }
}

std::string escaped_cell(std::string text) {
  for (std::size_t i = text.find('|'); i != std::string::npos; i = text.find('|', i + 2))
    text.insert(i, "\\");
  return text;
}

void add_rows(std::string& text, const std::vector<ParamInfo>& params, const std::string& prefix) {
  for (const ParamInfo& param : params) {
    std::string doc = param.doc;
    for (const ChoiceInfo& choice : param.type.choices)
      doc += fmt::format(" `{}`: {}", choice.name, choice.doc);
    const auto* nested = nested_params(param.type);
    const std::string fallback = nested != nullptr && !param.range.is_required ? "" : default_text(param);
    text += fmt::format("| `{}` | {} | {} | {} | {} |\n", prefix + param.name, escaped_cell(type_text(param)),
                        fallback.empty() || param.range.is_required ? fallback : "`" + fallback + "`",
                        param.range.text(), escaped_cell(doc));
    if (nested != nullptr) add_rows(text, *nested, prefix + nested_prefix(param));
  }
}

}  // namespace

bool is_plain_word(const std::string& text) {
  static constexpr std::array<std::string_view, 8> kWords{"true", "false", "yes",  "no",
                                                          "on",   "off",   "null", "y"};
  if (text.empty() || parse_number(text) || text.back() == ' ') return false;
  std::string lower = text;
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  if (lower == "n" || std::find(kWords.begin(), kWords.end(), lower) != kWords.end()) return false;
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || c == '_' || c == '/'; };
  const auto is_safe = [&](char c) {
    return is_letter(c) || (c >= '0' && c <= '9') || c == '.' || c == '-' || c == '+' || c == ' ';
  };
  return (is_letter(lower[0]) || lower[0] == '.') && std::all_of(lower.begin(), lower.end(), is_safe);
}

std::string flow_text(const Value& value) {
  std::vector<std::string> parts;
  switch (value.kind) {
    case Value::Kind::kNull:
      return "null";
    case Value::Kind::kScalar:
      return value.is_quoted ? quoted(value.text) : value.text;
    case Value::Kind::kList:
      for (const Value& item : value.items) parts.push_back(flow_text(item));
      return fmt::format("[{}]", fmt::join(parts, ", "));
    case Value::Kind::kMap:
      for (const Value::Entry& entry : value.entries)
        parts.push_back(entry.key + ": " + flow_text(entry.value));
      return fmt::format("{{{}}}", fmt::join(parts, ", "));
  }
  return {};
}

std::string type_text(const ParamInfo& param) {
  const std::string words = words_of(param.type, param.quantity);
  return param.type.is_optional ? words + " | null" : words;
}

std::string help_text(const std::vector<ParamInfo>& params) {
  std::string text;
  add_help(text, params, "");
  return text;
}

std::string markdown_table(const std::vector<ParamInfo>& params) {
  if (params.empty()) return {};
  std::string text = "| Key | Form | Default | Range | Meaning |\n|---|---|---|---|---|\n";
  add_rows(text, params, "");
  return text;
}

std::string json_schema(const std::vector<ParamInfo>& params) {
  return object_schema(params).dump();
}

std::string json_list(const std::vector<ParamInfo>& params) {
  return param_list(params).dump();
}

}  // namespace periost
