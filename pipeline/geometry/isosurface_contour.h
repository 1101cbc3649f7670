#pragma once
// Distances to the curves where an open isosurface ends. Points and lengths in LPS mm. Pure functions, safe
// from several threads.
#include <cstdint>
#include <optional>
#include <vector>

#include "pipeline/data/isosurface.h"

namespace periost {

// Per triangle, bit k is set when its side opposite corner k belongs to no other triangle. Empty when there
// is no such side. O(n log n).
std::vector<std::uint8_t> open_sides(const SurfaceMesh& surface);

// A point of the isosurface's border near a query point.
struct ContourPoint {
  Vec3 point;
  double distance = 0;  // from the query point, >= 0
  Vec3 direction;       // unit vector along the border there, the surface on its left seen from outside
};

// The closest point to p, exact, on the sides of `open` that run along `direction` (positive dot product; all
// sides when it is zero), or nothing within `within_mm`. Looks at all cells around p within that distance, so
// keep it to a few voxels. Ties go to the triangle with the lower index. Precondition: p is finite; `open` is
// empty or open_sides(isosurface.surface).
std::optional<ContourPoint> closest_on_contour(const Isosurface& isosurface,
                                               const std::vector<std::uint8_t>& open, Vec3 p, Vec3 direction,
                                               double within_mm);

}  // namespace periost
