#include "pipeline/geometry/measure_quality.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "pipeline/geometry/measure_surface.h"
#include "pipeline/geometry/measure_volume.h"
#include "pipeline/geometry/surface_distance.h"
#include "pipeline/geometry/tet_quality.h"
#include "pipeline/geometry/wall_thickness.h"

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

// Where the worst tetrahedra stand in walls thinner than they are long, the isosurface leaves room for no
// better ones: their origin says so.
void name_thin_walls(const TetMesh& mesh, const SurfaceMesh& isosurface, WorstElements& worst) {
  std::map<std::uint64_t, std::string> known;  // most stand in several lists
  const auto wall_of = [&](const WorstElement& element) -> std::string {
    const TetCorners c = tet_corners(mesh, element.element);
    double longest = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t j = 0; j < i; ++j) longest = std::max(longest, distance(c[i], c[j]));
    }
    if (!(longest > 0)) return "";
    const auto thickness = wall_thickness(isosurface, element.centre_mm, longest);
    if (!thickness || *thickness >= longest) return "";
    return fmt::format(", in a wall of the isosurface that is {:.2g} mm thick", *thickness);
  };
  for (auto& [metric, elements] : worst) {
    if (metric.rfind("volume.", 0) != 0) continue;
    for (WorstElement& element : elements) {
      auto [at, is_new] = known.try_emplace(element.element);
      if (is_new) at->second = wall_of(element);
      element.origin += at->second;
    }
  }
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
    if (inputs.isosurface != nullptr && report.isosurface->closed)
      name_thin_walls(*inputs.tet_mesh, *inputs.isosurface, measurement.worst);
  }
  return measurement;
}

}  // namespace periost
