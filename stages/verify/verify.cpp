#include "stages/verify/verify.h"

#include <fmt/format.h>

#include <optional>
#include <utility>

#include "pipeline/geometry/measure_volume.h"
#include "pipeline/geometry/topology.h"
#include "pipeline/mechanics/fitness.h"
#include "stages/verify/hints.h"
#include "stages/verify/reference.h"

namespace periost {
namespace {

void log_gates(const QualityReport& report, const Context& context) {
  std::size_t warned = 0, failed = 0;
  for (const GateResult& gate : report.gates) {
    if (gate.status == Verdict::kPass) continue;
    const bool has_failed = gate.status == Verdict::kFail;
    ++(has_failed ? failed : warned);
    context.warn(has_failed ? "quality.fail" : "quality.warn", describe(gate));
  }
  context.info("quality.verdict",
               fmt::format("{} gates: {} passed, {} warned, {} failed", report.gates.size(),
                           report.gates.size() - warned - failed, warned, failed));
}

std::optional<MechanicsQuality> check_mechanics(const TetMesh& mesh, const TetMesh* reference,
                                                MechanicsCheck check, WorstElements& worst,
                                                const Context& context) {
  if (check == MechanicsCheck::kNone) return std::nullopt;
  std::optional<MechanicsQuality> quality = measure_fitness(mesh, context, worst);
  if (quality && check == MechanicsCheck::kReference && reference != nullptr) {
    quality->reference = compare_with_reference(mesh, *reference, context);
  }
  return quality;
}

}  // namespace

MechanicsCheck mechanics_of(const VerifyOptions& options) {
  if (options.mechanics != MechanicsCheck::kByPreset) return options.mechanics;
  struct Row {
    Preset preset;
    MechanicsCheck check;
  };
  constexpr Row kRows[] = {{Preset::kNone, MechanicsCheck::kNone},
                           {Preset::kLenient, MechanicsCheck::kNone},
                           {Preset::kFeStandard, MechanicsCheck::kBasic},
                           {Preset::kFeStrict, MechanicsCheck::kBasic}};
  for (const Row& row : kRows) {
    if (row.preset == options.preset) return row.check;
  }
  return MechanicsCheck::kNone;
}

QualityReport verify(const VerifyInputs& inputs, const VerifyOptions& options, Context& context) {
  QualityInputs measured;
  std::optional<SurfaceMesh> boundary, kept;
  if (inputs.isosurface != nullptr) measured.isosurface = &inputs.isosurface->surface;
  DecimationReport decimation;
  if (inputs.simplex_mesh != nullptr) {
    decimation = inputs.simplex_mesh->report;
    decimation.requested_distance_mm = configured_distance_mm(*inputs.simplex_mesh, inputs.hints);
    measured.decimation = &decimation;
  }
  // What was dropped on request is not missed.
  if (measured.isosurface && measured.decimation && measured.decimation->dropped_below > 0) {
    kept = without_small_components(*measured.isosurface, measured.decimation->dropped_below);
    measured.isosurface = &*kept;
  }
  measured.surface = inputs.surface;
  measured.tet_mesh = inputs.tet_mesh;
  if (measured.surface == nullptr && measured.tet_mesh != nullptr) {
    boundary = boundary_surface(*measured.tet_mesh);
    measured.surface = &*boundary;
  }
  MeasureOptions measure_options;
  measure_options.distance_spacing = options.distance_spacing;
  Measurement measurement = measure_quality(measured, measure_options, context);
  if (inputs.tet_mesh != nullptr) {
    measurement.report.mechanics = check_mechanics(*inputs.tet_mesh, inputs.reference, mechanics_of(options),
                                                   measurement.worst, context);
  }
  apply_gates(measurement.report, measurement.worst, options.preset, options.gates);
  log_gates(measurement.report, context);
  return std::move(measurement.report);
}

}  // namespace periost
