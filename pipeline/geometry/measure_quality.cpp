#include "pipeline/geometry/measure_quality.h"

#include "pipeline/geometry/measure_surface.h"
#include "pipeline/geometry/measure_volume.h"
#include "pipeline/geometry/surface_distance.h"

namespace periost {
namespace {

double voxel_of(const QualityInputs& inputs) {
  if (inputs.voxel_mm > 0) return inputs.voxel_mm;
  if (inputs.isosurface != nullptr && inputs.isosurface->voxel_mm > 0) return inputs.isosurface->voxel_mm;
  return inputs.surface != nullptr ? inputs.surface->voxel_mm : 0;
}

std::vector<WorstElement> scaled(std::vector<WorstElement> worst, double unit) {
  for (WorstElement& element : worst) element.value /= unit;
  return worst;
}

// What compares the surface with the isosurface.
void compare(const QualityInputs& inputs, const MeasureOptions& options, const Context& context,
             double voxel_mm, Measurement& measurement) {
  const IsosurfaceQuality& isosurface = *measurement.report.isosurface;
  SurfaceQuality& surface = *measurement.report.surface;
  surface.same_topology = surface.components == isosurface.components && surface.euler == isosurface.euler;
  if (surface.closed && isosurface.closed && isosurface.volume_mm3 != 0) {
    surface.volume_change = (*surface.volume_mm3 - isosurface.volume_mm3) / isosurface.volume_mm3;
  }
  if (inputs.surface->triangles.empty() || inputs.isosurface->triangles.empty()) return;
  const double unit = voxel_mm > 0 ? voxel_mm : 1;
  DistanceOptions distance_options;
  distance_options.spacing_mm = options.distance_spacing.in_mm(voxel_mm);
  const TwoSidedDistance distance =
      two_sided_distance(*inputs.surface, *inputs.isosurface, distance_options, context);
  std::optional<double> requested;
  if (inputs.decimation != nullptr) requested = inputs.decimation->requested_distance_mm;
  surface.distance = summarise(distance, voxel_mm, requested);

  auto forward = scaled(distance.forward.worst, unit), backward = scaled(distance.backward.worst, unit);
  for (WorstElement& element : backward) element.origin = "triangle of the isosurface";
  const bool forward_is_worse = distance.forward.summary.max >= distance.backward.summary.max;
  measurement.worst["surface.distance"] = forward_is_worse ? forward : backward;
  measurement.worst["surface.distance.surface_to_isosurface"] = std::move(forward);
  measurement.worst["surface.distance.isosurface_to_surface"] = std::move(backward);
}

}  // namespace

Measurement measure_quality(const QualityInputs& inputs, const MeasureOptions& options,
                            const Context& context) {
  Measurement measurement;
  QualityReport& report = measurement.report;
  const double voxel_mm = voxel_of(inputs);
  if (inputs.isosurface != nullptr) report.isosurface = measure_isosurface(*inputs.isosurface, voxel_mm);
  if (inputs.decimation != nullptr) report.decimation = *inputs.decimation;
  if (inputs.surface != nullptr) {
    report.surface = measure_surface(*inputs.surface, options, context, measurement.worst);
  }
  if (inputs.isosurface != nullptr && inputs.surface != nullptr) {
    compare(inputs, options, context, voxel_mm, measurement);
  }
  if (inputs.tet_mesh != nullptr) {
    report.volume = measure_volume(*inputs.tet_mesh, context, measurement.worst);
  }
  return measurement;
}

}  // namespace periost
