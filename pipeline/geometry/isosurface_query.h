#pragma once
// Distances to an isosurface, found through its voxels (Delingette 1997, section 3.2). All points, normals
// and lengths are in the LPS frame in millimetres, for any orientation or handedness of the grid. Pure
// functions; safe from several threads; no allocation.
#include <optional>

#include "pipeline/data/isosurface.h"
#include "pipeline/geometry/closest_point.h"

namespace periost {

// A point of the isosurface near a query point.
struct IsosurfacePoint {
  Vec3 point;
  double distance = 0;        // from the query point, >= 0
  Index triangle = kNoIndex;  // the triangle that `point` lies on
};

// A cell by its indices; see Isosurface for their range.
struct Cell {
  std::int32_t i = 0;
  std::int32_t j = 0;
  std::int32_t k = 0;
  friend bool operator==(const Cell&, const Cell&) = default;
};

// The cell that holds a point, also for points outside the grid. Precondition: p is finite.
Cell cell_at(const GridFrame& frame, Vec3 p);

// The cell that holds a triangle. O(log triangles). Precondition: triangle < number of triangles.
Cell cell_of_triangle(const Isosurface& isosurface, Index triangle);

// The closest point of the isosurface to p, exact, or nothing when none lies within `within_mm`. Looks at the
// cells around p in growing shells until none nearer is possible, so the time grows with the cube of the
// distance found. Ties go to the triangle with the lower index. Precondition: p is finite.
std::optional<IsosurfacePoint> closest_point(const Isosurface& isosurface, Vec3 p, double within_mm);

// The isosurface point M of section 3.2: the nearest intersection of the surface with the line through p
// along `unit_normal`, looking both ways up to `within_mm`, among triangles that face the normal's side
// (n . N > 0; without this test thin sheets collapse). Nothing when there is none. The distance is never less
// than that of closest_point. Walks the cells on the line only. Preconditions: p is finite, |unit_normal|
// = 1.
std::optional<IsosurfacePoint> closest_along_line(const Isosurface& isosurface, Vec3 p, Vec3 unit_normal,
                                                  double within_mm);

}  // namespace periost
