#pragma once
// Quality gates: the metrics that a report holds, the presets, and the verdict. Three tables, no branches: a
// new metric is a row in metrics(), a new preset a column in preset_rows().
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/data/quality_report.h"
#include "pipeline/geometry/measure_quality.h"

namespace periost {

// One number of a report.
struct Metric {
  std::string path;  // in quality.json: "surface.min_angle_deg.p01"; also the gate's name
  std::string unit;  // "deg", "mm^3", "voxel", ... or empty for a pure number
  std::string op;    // how a gate compares: value OP limit passes; ">=", ">", "<=" or "=="
  std::string doc;   // one sentence
  // The number as it stands in quality.json, true as 1; empty when it was not measured.
  std::function<std::optional<double>(const QualityReport&)> value;
  bool by_magnitude = false;  // a gate looks at the absolute value
  // Whether gates look at it in this report; none: always.
  std::function<bool(const QualityReport&)> is_gated{};
};

// Every metric, in the order of quality.json.
const std::vector<Metric>& metrics();
// The metric of a path, or null.
const Metric* find_metric(const std::string& path);
// The path nearest to a misspelt one, or empty.
std::string nearest_metric(const std::string& path);

// A gate fails when the value does not meet `limit`, else warns when it does not meet `warn`. Either may be
// absent: `warn` alone never fails.
struct GateLimits {
  std::optional<double> limit, warn;
  friend bool operator==(const GateLimits&, const GateLimits&) = default;
};
using GateOverrides = std::map<std::string, GateLimits>;  // by metric path

enum class Preset { kNone, kLenient, kFeStandard, kFeStrict };
std::string name_of(Preset preset);  // "none", "lenient", "fe-standard", "fe-strict"
std::optional<Preset> preset_from_name(const std::string& name);

// The table of presets: one row per gated metric, one pair of limits per preset (docs/quality.md prints it).
struct PresetRow {
  const char* metric;
  GateLimits lenient, fe_standard, fe_strict;
  // The row's limits in a preset; both absent: not gated.
  const GateLimits& in(Preset preset) const;
};
const std::vector<PresetRow>& preset_rows();

// Judges a report: rows of the preset, replaced by those of `overrides`, further overrides behind them. Rows
// on metrics that were not measured or are not gated in this report (Metric::is_gated) are left out, as are
// preset rows in voxels where distances are in mm.
// Every result carries the worst elements that `worst` knows. Sets report.preset, gates and verdict.
// Precondition: every overridden path is a metric.
void apply_gates(QualityReport& report, const WorstElements& worst, Preset preset,
                 const GateOverrides& overrides);

// One sentence about a gate that warned or failed: metric, value, limit and the worst place in mm.
std::string describe(const GateResult& gate);

}  // namespace periost
