#include "pipeline/config/environment.h"

#include <fmt/format.h>

#include <cstdlib>
#include <string_view>

namespace periost {
namespace {

bool is_name(std::string_view name) {
  if (name.empty() || (name[0] >= '0' && name[0] <= '9')) return false;
  for (const char c : name) {
    const bool is_letter =
        (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
    if (!is_letter) return false;
  }
  return true;
}

void expand_scalar(Value& value, const Environment& environment, Diagnostics& diagnostics) {
  const auto error = [&](const char* code, const std::string& text, const std::string& hint) {
    diagnostics.push_back({Severity::kError, code, {}, {}, value.place, text, hint});
  };
  const std::string_view text = value.text;
  std::string expanded;
  for (std::size_t i = 0; i < text.size();) {
    if (text.substr(i, 3) == "$${") {
      expanded += "${";
      i += 3;
      continue;
    }
    if (text.substr(i, 2) != "${") {
      expanded += text[i++];
      continue;
    }
    const std::size_t end = text.find('}', i);
    const std::string name(text.substr(i + 2, end == std::string_view::npos ? end : end - i - 2));
    if (end == std::string_view::npos || !is_name(name)) {
      error("config.syntax", fmt::format("'{}' is not of the form ${{NAME}}", text),
            "write $${ for a plain ${");
      return;
    }
    const std::optional<std::string> content = environment(name);
    if (!content) {
      error("config.undefined_variable", fmt::format("the environment variable '{}' is not set", name),
            fmt::format("run with {}=...", name));
      return;
    }
    expanded += *content;
    i = end + 1;
  }
  value.text = std::move(expanded);
}

}  // namespace

Environment process_environment() {
  return [](const std::string& name) -> std::optional<std::string> {
    const char* content = std::getenv(name.c_str());
    return content == nullptr ? std::nullopt : std::optional<std::string>(content);
  };
}

void expand_environment(Value& document, const Environment& environment, Diagnostics& diagnostics) {
  if (document.kind == Value::Kind::kScalar) expand_scalar(document, environment, diagnostics);
  for (Value& item : document.items) expand_environment(item, environment, diagnostics);
  for (Value::Entry& entry : document.entries) expand_environment(entry.value, environment, diagnostics);
}

}  // namespace periost
