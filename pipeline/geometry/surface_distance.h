#pragma once
// The distance between two surfaces, both ways, over their whole area and not at their vertices only.
#include <optional>
#include <vector>

#include "pipeline/base/context.h"
#include "pipeline/data/quality_report.h"
#include "pipeline/data/surface_mesh.h"
#include "pipeline/geometry/spatial_search.h"

namespace periost {

struct DistanceOptions {
  double spacing_mm = 0;         // longest side of a sampled piece; 0: the mean edge of the finer surface
  double max_tolerance = 0.005;  // the true maximum exceeds the reported one by at most this share of it
};

// Distances in mm from every part of one surface to another.
struct OneSidedDistance {
  DistanceSummary summary;
  std::vector<WorstElement> worst;  // the ten triangles farthest away, each at its farthest sample
};

// Every triangle of `from` is cut into equal pieces of sides up to the spacing. Mean, rms and p99 weigh with
// its area the distance at three points of each piece, the rule that is exact for quadratic functions. The
// maximum is bounded, not sampled: inside a piece the distance to `to` is at most the largest distance of its
// corners to any one triangle of `to` (the distance to a triangle is convex); where that bound exceeds the
// largest distance found by more than the tolerance, and a hundredth of the spacing, the piece is quartered,
// to a depth of 12. So a maximum below a hundredth of the spacing is a sampled one. Closest points are exact.
// Deterministic for any number of threads. About two microseconds a piece. Empty surfaces give zeros.
// Preconditions: indices in range, points finite.
OneSidedDistance distance_to(const SurfaceMesh& from, const SpatialSearch& to, const DistanceOptions& options,
                             const Context& context);

struct TwoSidedDistance {
  OneSidedDistance forward;   // from the first surface to the second
  OneSidedDistance backward;  // from the second to the first
};

// Both directions. Precondition: neither is empty.
TwoSidedDistance two_sided_distance(const SurfaceMesh& first, const SurfaceMesh& second,
                                    const DistanceOptions& options, const Context& context);

// As it goes to the report: in voxels of `voxel_mm`, or in mm when that is 0. `requested_mm` is what the
// decimator was asked, if it was.
SurfaceDistance summarise(const TwoSidedDistance& distance, double voxel_mm,
                          std::optional<double> requested_mm);

}  // namespace periost
