// docs/quality.md says what is measured and what passes; here it is held to the tables of the program.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "pipeline/base/file.h"
#include "pipeline/base/quantity.h"
#include "pipeline/geometry/gates.h"

namespace periost {
namespace {

std::string document() {
  return read_text(std::filesystem::path(PERIOST_SOURCE_DIR) / "docs" / "quality.md");
}

// The line of a table whose first cell is `path` in backquotes, or empty.
std::string row_of(const std::string& text, const std::string& path, const std::string& heading) {
  const std::size_t section = text.find("\n## " + heading);
  if (section == std::string::npos) return {};
  const std::string within = text.substr(section, text.find("\n## ", section + 1) - section);
  const std::size_t at = within.find("\n| `" + path + "` |");
  return at == std::string::npos ? std::string() : within.substr(at + 1, within.find('\n', at + 1) - at - 1);
}

std::string cell(const GateLimits& limits) {
  std::string text;
  if (limits.limit) text = to_text(*limits.limit);
  if (limits.warn) text += fmt::format("{}warn {}", text.empty() ? "" : ", ", to_text(*limits.warn));
  return text.empty() ? "–" : text;
}

// As it has to be written in the cell of a table.
std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) result += c == '|' ? std::string("\\|") : std::string(1, c);
  return result;
}

// Members of a distribution share one row, without the last word of the path.
bool is_of_distribution(const std::string& path) {
  return find_metric(path.substr(0, path.rfind('.')) + ".p50") != nullptr;
}

TEST(QualityDocument, EveryMetricHasARowWithItsUnitAndSentence) {
  const std::string text = document();
  for (const Metric& metric : metrics()) {
    const std::string path =
        is_of_distribution(metric.path) ? metric.path.substr(0, metric.path.rfind('.')) : metric.path;
    EXPECT_EQ(row_of(text, path, "Metrics"),
              fmt::format("| `{}` | {} | {} | {} |", path, metric.unit, metric.op, escaped(metric.doc)))
        << "docs/quality.md lacks this row of its first table";
  }
}

TEST(QualityDocument, EveryRowOfThePresetsIsPrintedWithItsLimits) {
  const std::string text = document();
  for (const PresetRow& row : preset_rows()) {
    EXPECT_EQ(row_of(text, row.metric, "Presets"),
              fmt::format("| `{}` | {} | {} | {} | {} |", row.metric, find_metric(row.metric)->op,
                          cell(row.lenient), cell(row.fe_standard), cell(row.fe_strict)))
        << "docs/quality.md lacks this row of the presets";
  }
}

}  // namespace
}  // namespace periost
