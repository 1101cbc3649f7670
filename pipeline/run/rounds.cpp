#include "pipeline/run/rounds.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "pipeline/base/error.h"

namespace periost {

namespace fs = std::filesystem;

constexpr double kMostShortfall = 1e6;

void add_report(const QualityReport& report, std::size_t step, RoundScore& score) {
  const bool has_failed = report.verdict == Verdict::kFail;
  if (!score.has_failed) score.reached = step + (has_failed ? 0 : 1);
  score.is_judged = true;
  score.has_warned = score.has_warned || report.verdict == Verdict::kWarn;
  score.has_failed = score.has_failed || has_failed;
  for (const GateResult& gate : report.gates) {
    if (gate.status == Verdict::kWarn) ++score.warned;
    if (gate.status != Verdict::kFail) continue;
    const double limit = gate.limit.value_or(0);
    const double shortfall = std::abs(gate.value - limit) / (limit == 0 ? 1 : std::abs(limit));
    score.shortfall += shortfall < kMostShortfall ? shortfall : kMostShortfall;  // also where it is no number
    ++score.failed;
    score.failed_metrics.push_back(gate.metric);
  }
}

bool is_better(const RoundScore& a, const RoundScore& b) {
  return std::tuple(-static_cast<std::int64_t>(a.reached), a.failed, a.shortfall, a.warned) <
         std::tuple(-static_cast<std::int64_t>(b.reached), b.failed, b.shortfall, b.warned);
}

std::string reason_to_end(const RoundEnd& end) {
  if (end.has_passed) return "pass";
  if (end.round >= end.max_rounds) return "max_rounds";
  const bool is_fruitless = !end.has_new_hints || end.round - end.best >= kFruitlessRounds;
  return is_fruitless ? "no_improvement" : "";
}

std::string round_folder(std::uint32_t round) {
  return fmt::format("rounds/{}", round);
}

std::vector<std::string> files_of(const std::vector<StageRecord>& stages) {
  std::vector<std::string> names;
  for (const StageRecord& stage : stages) {
    for (const OutputRecord& output : stage.outputs) {
      if (!output.file.empty()) names.push_back(output.file);
      for (const FileRecord& file : output.files) names.push_back(file.file);
    }
  }
  return names;
}

void put_files(const std::vector<std::string>& names, const fs::path& from, const fs::path& to) {
  for (const std::string& name : names) {
    const fs::path target = to / name;
    const fs::path partial = target.parent_path() / ("." + target.filename().string() + ".partial");
    std::error_code failure;
    fs::create_directories(target.parent_path(), failure);
    fs::remove(partial, failure);
    fs::create_hard_link(from / name, partial, failure);
    if (failure) fs::copy_file(from / name, partial, failure);
    if (!failure) fs::rename(partial, target, failure);
    if (failure) {
      throw Error(ErrorKind::kLimit, "file.unwritable",
                  fmt::format("cannot put '{}' into '{}': {}", name, to.string(), failure.message()));
    }
    // Where both names are of one file already, renaming leaves them as they are.
    fs::remove(partial, failure);
  }
}

}  // namespace periost
