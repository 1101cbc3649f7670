#include "pipeline/config/emit.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

namespace periost {
namespace {

bool is_null_word(std::string_view text) {
  return text.empty() || text == "~" || text == "null" || text == "Null" || text == "NULL";
}

// Whether YAML reads the text back as this very scalar without quotes, in block and in flow context.
bool is_plain_scalar(std::string_view text) {
  if (is_null_word(text) || text.front() == ' ' || text.back() == ' ' || text.back() == ':') return false;
  if (text == "---" || text == "..." || text == "<<" || text == "-" || text == "?") return false;
  if (std::string_view("!&*|>@%`\"'#,[]{}:?").find(text.front()) != std::string_view::npos) return false;
  if (text.front() == '-' && (text.size() < 2 || text[1] == ' ' || text[1] == '-')) return false;
  if (text.find(": ") != std::string_view::npos || text.find(" #") != std::string_view::npos) return false;
  return std::all_of(text.begin(), text.end(), [](char c) {
    return c >= ' ' && c < '\x7F' && std::string_view(",[]{}?").find(c) == std::string_view::npos;
  });
}

std::string in_quotes(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\')
      quoted += std::string{'\\', c};
    else if (c == '\n')
      quoted += "\\n";
    else if (c == '\t')
      quoted += "\\t";
    else if ((c >= 0 && c < ' ') || c == '\x7F')
      quoted += fmt::format("\\x{:02x}", static_cast<unsigned>(c));
    else
      quoted += c;
  }
  return quoted + "\"";
}

std::string escaped(std::string text) {
  for (std::size_t i = text.find("${"); i != std::string::npos; i = text.find("${", i + 3))
    text.insert(i, "$");
  return text;
}

std::string scalar_text(const Value& value) {
  const std::string text = escaped(value.text);
  return !value.is_quoted && is_plain_scalar(text) ? text : in_quotes(text);
}

std::string key_text(const std::string& key) {
  return is_plain_scalar(key) ? key : in_quotes(key);
}

bool is_leaf(const Value& value) {
  return value.kind == Value::Kind::kNull || value.kind == Value::Kind::kScalar;
}

// A value on one line, when it has no map inside.
bool is_flow(const Value& value) {
  if (value.kind == Value::Kind::kMap) return value.entries.empty();
  return is_leaf(value) || std::all_of(value.items.begin(), value.items.end(), is_flow);
}

std::string flow(const Value& value) {
  if (value.kind == Value::Kind::kNull) return "null";
  if (value.kind == Value::Kind::kScalar) return scalar_text(value);
  if (value.kind == Value::Kind::kMap) return "{}";
  std::string text = "[";
  for (const Value& item : value.items) text += (text.size() > 1 ? ", " : "") + flow(item);
  return text + "]";
}

void emit_map(std::string& out, const Value& map, int indent, bool starts_on_line);

void emit_list(std::string& out, const Value& list, int indent) {
  for (const Value& item : list.items) {
    out += std::string(static_cast<std::size_t>(indent), ' ') + "- ";
    if (is_flow(item)) {
      out += flow(item) + "\n";
    } else if (item.kind == Value::Kind::kMap) {
      emit_map(out, item, indent + 2, true);
    } else {
      out += "\n";
      emit_list(out, item, indent + 2);
    }
  }
}

// `starts_on_line`: the first key continues a line that already has its indentation.
void emit_map(std::string& out, const Value& map, int indent, bool starts_on_line) {
  for (const Value::Entry& entry : map.entries) {
    if (!starts_on_line) out += std::string(static_cast<std::size_t>(indent), ' ');
    starts_on_line = false;
    out += key_text(entry.key) + ":";
    if (is_flow(entry.value)) {
      out += " " + flow(entry.value) + "\n";
      continue;
    }
    out += "\n";
    if (entry.value.kind == Value::Kind::kMap)
      emit_map(out, entry.value, indent + 2, false);
    else
      emit_list(out, entry.value, indent + 2);
  }
}

}  // namespace

std::string emit_yaml(const Value& document) {
  if (document.entries.empty()) return "{}\n";
  std::string out;
  emit_map(out, document, 0, false);
  return out;
}

}  // namespace periost
