#include "pipeline/run/summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "pipeline/base/quantity.h"

namespace periost {
namespace {

// "1,234,567".
std::string grouped(double value) {
  std::string digits = fmt::format("{:.0f}", value);
  for (std::size_t at = digits.size(); at > 3 && at - 3 > (value < 0 ? 1u : 0u);) {
    at -= 3;
    digits.insert(at, 1, ',');
  }
  return digits;
}

std::string fact_text(const std::string& name, double value) {
  if (name == "rate") return fmt::format("rate {:.1f} %", 100 * value);
  if (name == "order") return fmt::format("order {:.0f}", value);
  std::string noun = name;
  std::replace(noun.begin(), noun.end(), '_', ' ');
  return grouped(value) + " " + noun;
}

std::string facts_text(const OutputRecord& output) {
  std::string text = output.kind;
  std::replace(text.begin(), text.end(), '_', ' ');
  const auto& facts = output.facts;
  if (facts.contains("size_i")) {
    text += fmt::format(" {} x {} x {}", facts.at("size_i"), facts.at("size_j"), facts.at("size_k"));
  }
  const char* separator = ": ";
  for (const auto& [name, value] : facts) {
    if (name.rfind("size_", 0) == 0) continue;
    text += separator + fact_text(name, value);
    separator = ", ";
  }
  return text;
}

std::size_t id_width(const std::vector<std::string>& ids) {
  std::size_t width = 5;
  for (const std::string& id : ids) width = std::max(width, id.size());
  return width;
}

std::string forecast_text(const std::map<std::string, Forecast>& outputs) {
  std::string text;
  for (const auto& [port, forecast] : outputs) {
    if (!text.empty()) text += "; ";
    text += port;
    if (forecast.dims[0] > 0) {
      text += fmt::format(" {} x {} x {}", forecast.dims[0], forecast.dims[1], forecast.dims[2]);
    }
    if (forecast.triangles > 0)
      text += " up to " + grouped(static_cast<double>(forecast.triangles)) + " triangles";
    if (forecast.tets > 0) text += " about " + grouped(static_cast<double>(forecast.tets)) + " tets";
  }
  return text;
}

std::string memory_text(std::uint64_t bytes) {
  return bytes == 0 ? "-" : mebibytes(bytes);
}

// One line a round, where there were rounds.
std::string rounds_table(const Manifest& manifest) {
  std::string text;
  if (manifest.rounds.size() < 2) return text;
  for (const RoundRecord& round : manifest.rounds) {
    text += fmt::format("round {}{}: {}", round.round, round.is_best ? " (best)" : "",
                        round.verdict.empty() ? "no verdict" : round.verdict);
    if (!round.failed_gates.empty()) text += fmt::format(" ({})", fmt::join(round.failed_gates, ", "));
    if (round.error) text += ", " + round.error->text;
    for (const RoundChange& change : round.changed) {
      text += fmt::format("{}{}: {}", &change == round.changed.data() ? "; then " : ", ", change.key,
                          change.text);
    }
    if (!round.ended.empty()) text += "; ended: " + round.ended;
    text += "\n";
  }
  return text;
}

std::string verdict_text(const Manifest& manifest) {
  switch (manifest.status) {
    case RunStatus::kPassed:
      return manifest.rounds.empty() ? "finished" : "verdict: pass";
    case RunStatus::kWarned:
      return "verdict: warn (see quality.json)";
    case RunStatus::kGateFailed:
      return "verdict: fail (see quality.json)";
    case RunStatus::kFailed:
      return "failed: " + (manifest.error ? manifest.error->text : std::string());
    case RunStatus::kInterrupted:
      return "interrupted: go on with --resume";
  }
  return {};
}

}  // namespace

std::string plan_table(const Plan& plan) {
  std::vector<std::string> ids;
  for (const PlanStep& step : plan.steps) ids.push_back(step.id);
  const std::size_t width = id_width(ids);
  std::string text = fmt::format("{:<{}}  {:>10}  makes\n", "stage", width, "memory");
  for (const PlanStep& step : plan.steps) {
    text += fmt::format("{:<{}}  {:>10}  {}\n", step.id, width, memory_text(step.peak_bytes),
                        forecast_text(step.outputs));
  }
  text += rounds_text(plan);
  return text + fmt::format("{:<{}}  {:>10}  estimated peak of the whole run\n", "", width,
                            memory_text(plan.peak_bytes));
}

std::string rounds_text(const Plan& plan) {
  if (!plan.feedback) return {};
  std::vector<std::string> ids;
  for (const PlanStep& step : plan.steps) {
    if (step.repeats) ids.push_back(step.id);
  }
  return fmt::format("up to {} rounds, until the gates pass; from the second on: {}\n", plan.max_rounds(),
                     fmt::join(ids, ", "));
}

std::string run_table(const Manifest& manifest, const std::filesystem::path& folder) {
  std::vector<std::string> ids;
  for (const StageRecord& stage : manifest.stages) ids.push_back(stage.id);
  const std::size_t width = id_width(ids);
  std::string text;
  std::set<std::string> files;
  for (const StageRecord& stage : manifest.stages) {
    std::string made;
    for (const OutputRecord& output : stage.outputs) {
      made += (made.empty() ? "" : "; ") + facts_text(output);
      if (!output.file.empty()) files.insert(output.file);
      for (const FileRecord& file : output.files) files.insert(file.file);
    }
    const std::string time = stage.cached ? "cached" : fmt::format("{:.2f} s", stage.wall_s);
    text += fmt::format("{:<{}}  {:>9}  {}\n", stage.id, width, time, made);
  }
  text += fmt::format("{:<{}}  {:>9}  peak memory {}\n", "total", width,
                      fmt::format("{:.2f} s", manifest.wall_s), memory_text(manifest.peak_rss_bytes));
  text += rounds_table(manifest) + verdict_text(manifest) + "\n";
  text += fmt::format("{}: run.json{}{}\n", folder.string(), files.empty() ? "" : " ", fmt::join(files, " "));
  return text;
}

}  // namespace periost
