#include "pipeline/param/param_table.h"

#include <fmt/format.h>

#include <algorithm>

namespace periost {

std::string Range::text() const {
  const bool has_min = std::isfinite(min);
  const bool has_max = std::isfinite(max);
  if (has_min && min == max) return to_text(min);
  if (has_min && has_max && !min_excluded && !max_excluded) {
    return fmt::format("from {} to {}", to_text(min), to_text(max));
  }
  std::string words;
  if (has_min) words = fmt::format("{} {}", min_excluded ? "above" : "at least", to_text(min));
  if (has_min && has_max) words += " and ";
  if (has_max) words += fmt::format("{} {}", max_excluded ? "below" : "at most", to_text(max));
  return words;
}

void ParamTableBase::check_keys(const Value& map, const CodecScope& scope) const {
  std::vector<std::string> names;
  for (const ParamInfo& param : params_) names.push_back(param.name);
  for (const Value::Entry& entry : map.entries) {
    if (std::find(names.begin(), names.end(), entry.key) != names.end()) continue;
    const CodecScope at = scope.at(entry.key);
    const std::string near = nearest_name(entry.key, names);
    std::string hint;
    if (!near.empty())
      hint = fmt::format("did you mean '{}'?", near);
    else if (!names.empty())
      hint = fmt::format("known keys are {}", fmt::join(names, ", "));
    scope.diagnostics->push_back({Severity::kError,
                                  "config.unknown_key",
                                  {},
                                  at.key,
                                  entry.place,
                                  fmt::format("unknown key '{}'", at.key),
                                  hint});
  }
  for (const ParamInfo& param : params_) {
    if (!param.range.is_required || map.find(param.name) != nullptr) continue;
    const CodecScope at = scope.at(param.name);
    std::string hint = param.doc;
    if (!hint.empty() && hint.back() == '.') hint.pop_back();
    scope.diagnostics->push_back({Severity::kError,
                                  "config.missing_key",
                                  {},
                                  at.key,
                                  map.place,
                                  fmt::format("key '{}' is missing", at.key),
                                  std::move(hint)});
  }
}

}  // namespace periost
