#include "pipeline/geometry/isosurface_of_surface.h"

#include <algorithm>

#include "pipeline/geometry/topology.h"

namespace periost {

Isosurface isosurface_of_surface(const SurfaceMesh& surface) {
  Isosurface isosurface;
  isosurface.surface.points = surface.points;
  isosurface.surface.triangles = surface.triangles;
  isosurface.surface.was_read = surface.was_read;
  if (surface.triangles.empty()) return isosurface;
  double sum = 0;
  for (const Triangle& t : surface.triangles) {
    for (std::size_t k = 0; k < 3; ++k) sum += distance(surface.points[t[k]], surface.points[t[(k + 1) % 3]]);
  }
  const double mean = sum / (3 * static_cast<double>(surface.triangles.size()));
  GridFrame& frame = isosurface.frame;
  if (mean > 0) frame.spacing = {mean, mean, mean};
  frame.dims = {1, 1, 1};
  frame.origin = surface.points.front();
  for (const Vec3& p : surface.points) {
    for (std::size_t axis = 0; axis < 3; ++axis) frame.origin[axis] = std::min(frame.origin[axis], p[axis]);
  }
  const auto neighbours = triangle_neighbours(surface.triangles, surface.points.size());
  isosurface.is_open = std::any_of(neighbours.begin(), neighbours.end(), [](const auto& across) {
    return std::find(across.begin(), across.end(), kNoIndex) != across.end();
  });
  return isosurface;
}

}  // namespace periost
