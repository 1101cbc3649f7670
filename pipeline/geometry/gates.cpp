#include "pipeline/geometry/gates.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "pipeline/base/error.h"
#include "pipeline/base/quantity.h"

namespace periost {
namespace {

constexpr std::array<const char*, 4> kPresetNames{"none", "lenient", "fe-standard", "fe-strict"};

GateLimits fails(double limit) {
  return {limit, std::nullopt};
}
GateLimits fails(double limit, double warn) {
  return {limit, warn};
}
GateLimits warns(double warn) {
  return {std::nullopt, warn};
}
const GateLimits kOff;

bool meets(double value, const std::string& op, double limit) {
  if (op == ">=") return value >= limit;
  if (op == ">") return value > limit;
  if (op == "<=") return value <= limit;
  return value == limit;
}

Verdict judge(double value, const std::string& op, const GateLimits& limits) {
  if (limits.limit && !meets(value, op, *limits.limit)) return Verdict::kFail;
  if (limits.warn && !meets(value, op, *limits.warn)) return Verdict::kWarn;
  return Verdict::kPass;
}

// The elements listed under the path itself, else under the distribution that it belongs to.
std::vector<WorstElement> worst_of(const WorstElements& worst, const std::string& path) {
  if (const auto found = worst.find(path); found != worst.end()) return found->second;
  const auto found = worst.find(path.substr(0, path.rfind('.')));
  return found != worst.end() ? found->second : std::vector<WorstElement>{};
}

}  // namespace

std::string name_of(Preset preset) {
  return kPresetNames[static_cast<std::size_t>(preset)];
}

std::optional<Preset> preset_from_name(const std::string& name) {
  const auto found = std::find(kPresetNames.begin(), kPresetNames.end(), name);
  if (found == kPresetNames.end()) return std::nullopt;
  return static_cast<Preset>(found - kPresetNames.begin());
}

const GateLimits& PresetRow::in(Preset preset) const {
  switch (preset) {
    case Preset::kLenient:
      return lenient;
    case Preset::kFeStandard:
      return fe_standard;
    case Preset::kFeStrict:
      return fe_strict;
    case Preset::kNone:
      break;
  }
  return kOff;
}

const std::vector<PresetRow>& preset_rows() {
  static const std::vector<PresetRow> rows{
      // metric, lenient, fe-standard, fe-strict
      {"surface.closed", fails(1), fails(1), fails(1)},
      {"surface.manifold", fails(1), fails(1), fails(1)},
      {"surface.oriented", fails(1), fails(1), fails(1)},
      {"surface.same_topology", fails(1), fails(1), fails(1)},
      {"surface.self_intersections", fails(0), fails(0), fails(0)},
      {"surface.min_angle_deg.min", fails(2), fails(5, 15), fails(20)},
      {"surface.min_angle_deg.p01", kOff, fails(15, 20), fails(25)},
      {"surface.distance.hausdorff", fails(2), fails(1, 0.7), fails(0.5)},
      {"surface.distance.surface_to_isosurface.p99", kOff, fails(0.6), fails(0.4)},
      {"surface.distance.isosurface_to_surface.p99", kOff, fails(0.6), fails(0.4)},
      {"surface.distance.over_requested", fails(0.05), fails(0.05, 0.01), fails(0.01)},
      {"surface.volume_change", fails(0.05), fails(0.03, 0.01), fails(0.005)},
      {"volume.inverted", fails(0), fails(0), fails(0)},
      {"volume.min_dihedral_deg.min", fails(3), fails(8, 15), fails(15)},
      {"volume.min_dihedral_deg.p01", kOff, fails(18, 25), fails(25)},
      {"volume.max_dihedral_deg.max", fails(177), fails(170, 162), fails(160)},
      {"volume.radius_ratio.max", fails(50), fails(20, 12), fails(12)},
      {"volume.radius_ratio.p99", kOff, fails(6, 4), fails(3.5)},
      {"volume.scaled_jacobian.min", fails(0.005), fails(0.015, 0.05), fails(0.05)},
      {"volume.scaled_jacobian.p01", kOff, fails(0.12), fails(0.2)},
      {"volume.mean_ratio.min", fails(0.02), fails(0.05), fails(0.15)},
      {"volume.mean_ratio.p01", kOff, fails(0.2), fails(0.35)},
      {"volume.jacobian_ratio.min", fails(0), fails(0, 0.3), fails(0.5)},
      {"volume.size_ratio.p99", kOff, warns(3), fails(2)},
      {"mechanics.patch_test_error", fails(1e-9), fails(1e-9), fails(1e-9)},
      {"mechanics.rigid_modes", fails(6), fails(6), fails(6)},
      {"mechanics.condition_ratio", kOff, warns(20), warns(10)},
      {"mechanics.cg_ratio", kOff, warns(4), warns(3)},
      {"mechanics.reference.stiffness", fails(0.02), fails(0.02), fails(0.02)},
      {"mechanics.reference.energy", fails(0.02), fails(0.02), fails(0.02)},
      {"mechanics.reference.p95_von_mises", fails(0.05), fails(0.05), fails(0.05)},
  };
  return rows;
}

void apply_gates(QualityReport& report, const WorstElements& worst, Preset preset,
                 const GateOverrides& overrides) {
  report.preset = preset == Preset::kNone ? "" : name_of(preset);
  report.gates.clear();
  report.verdict = Verdict::kPass;
  const bool is_in_mm =
      report.surface && report.surface->distance && report.surface->distance->unit != "voxel";
  const auto add = [&](const std::string& path, const GateLimits& limits, bool is_preset_row) {
    const Metric* metric = find_metric(path);
    PERIOST_ASSERT(metric != nullptr);
    const std::optional<double> value = metric->value(report);
    if (!value || (!limits.limit && !limits.warn)) return;
    if (metric->is_gated && !metric->is_gated(report)) return;
    if (is_preset_row && is_in_mm && metric->unit == "voxel") return;
    const double judged = metric->by_magnitude ? std::abs(*value) : *value;
    GateResult gate{path,
                    metric->op,
                    limits.limit,
                    limits.warn,
                    *value,
                    judge(judged, metric->op, limits),
                    worst_of(worst, path)};
    report.verdict = std::max(report.verdict, gate.status);
    report.gates.push_back(std::move(gate));
  };
  for (const PresetRow& row : preset_rows()) {
    const auto changed = overrides.find(row.metric);
    add(row.metric, changed != overrides.end() ? changed->second : row.in(preset),
        changed == overrides.end());
  }
  for (const auto& [path, limits] : overrides) {
    const bool is_row = std::any_of(preset_rows().begin(), preset_rows().end(),
                                    [&](const PresetRow& row) { return row.metric == path; });
    if (!is_row) add(path, limits, false);
  }
}

std::string describe(const GateResult& gate) {
  const bool is_failure = gate.status == Verdict::kFail;
  const std::optional<double> limit = is_failure ? gate.limit : gate.warn;
  std::string text =
      fmt::format("{} is {:.6g}, {} {} {}", gate.metric, gate.value,
                  is_failure ? "the gate asks for" : "better were", gate.op, to_text(limit.value_or(0)));
  if (!gate.worst.empty()) {
    const WorstElement& worst = gate.worst.front();
    text += fmt::format("; worst at ({:.2f}, {:.2f}, {:.2f}) mm, element {}", worst.centre_mm.x,
                        worst.centre_mm.y, worst.centre_mm.z, worst.element);
    if (!worst.origin.empty()) text += ", " + worst.origin;
  }
  return text;
}

}  // namespace periost
