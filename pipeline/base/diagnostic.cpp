#include "pipeline/base/diagnostic.h"

#include <algorithm>
#include <numeric>

namespace periost {
namespace {

const char* name_of(Severity severity) {
  switch (severity) {
    case Severity::kNote:
      return "note";
    case Severity::kWarning:
      return "warning";
    case Severity::kError:
      return "error";
  }
  return "error";
}

// Levenshtein distance in which swapping two neighbouring letters also costs one.
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> before_last(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  std::iota(last.begin(), last.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substitution = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({substitution, last[j] + 1, row[j - 1] + 1});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) row[j] = std::min(row[j], before_last[j - 2] + 1);
    }
    std::swap(before_last, last);
    std::swap(last, row);
  }
  return last[b.size()];
}

}  // namespace

bool has_errors(const Diagnostics& diagnostics) {
  return std::any_of(diagnostics.begin(), diagnostics.end(),
                     [](const Diagnostic& d) { return d.severity == Severity::kError; });
}

std::string format(const Diagnostic& diagnostic) {
  std::string line;
  if (!diagnostic.place.file.empty()) {
    line += diagnostic.place.file + ":";
    if (diagnostic.place.line > 0) {
      line += std::to_string(diagnostic.place.line) + ":" + std::to_string(diagnostic.place.column) + ":";
    }
    line += " ";
  }
  line += std::string(name_of(diagnostic.severity)) + ": ";
  if (!diagnostic.stage.empty()) line += "stage '" + diagnostic.stage + "': ";
  line += diagnostic.text;
  if (!diagnostic.hint.empty()) line += "; " + diagnostic.hint;
  if (!diagnostic.code.empty()) line += " [" + diagnostic.code + "]";
  return line;
}

std::string nearest_name(const std::string& word, const std::vector<std::string>& candidates) {
  std::string best;
  std::size_t best_distance = std::max<std::size_t>(word.size() / 3, 1) + 1;
  for (const std::string& candidate : candidates) {
    const std::size_t distance = edit_distance(word, candidate);
    if (distance < best_distance) {
      best_distance = distance;
      best = candidate;
    }
  }
  return best;
}

}  // namespace periost
