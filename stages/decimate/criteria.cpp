#include "stages/decimate/criteria.h"

#include <algorithm>

#include "pipeline/geometry/isosurface_query.h"
#include "pipeline/geometry/simplex_geometry.h"
#include "pipeline/geometry/simplex_operators.h"

namespace periost {
namespace {

bool faces_the_same_way(const Isosurface& isosurface, Index triangle, Vec3 normal) {
  const Triangle& corners = isosurface.surface.triangles[triangle];
  const Vec3 a = isosurface.surface.points[corners[0]];
  const Vec3 n = cross(isosurface.surface.points[corners[1]] - a, isosurface.surface.points[corners[2]] - a);
  return dot(n, normal) > 0;
}

}  // namespace

double barycentric_deficit(const SimplexMesh& mesh, SimplexVertex v, double least) {
  const SimplexParameters s = simplex_parameters(mesh, v);
  if (s.is_degenerate) return 1;
  double deficit = 0;
  for (const double e : s.barycentric) deficit += std::max(0.0, least - e);
  return deficit;
}

double distance_deficit(const Isosurface& isosurface, Vec3 p, Vec3 unit_normal, double tolerance_mm) {
  if (closest_along_line(isosurface, p, unit_normal, tolerance_mm)) return 0;
  const auto closest = closest_point(isosurface, p, 3 * tolerance_mm);
  if (!closest || !faces_the_same_way(isosurface, closest->triangle, unit_normal)) return 2 * tolerance_mm;
  return std::max(0.0, closest->distance - tolerance_mm);
}

double vertex_distance_deficit(const Isosurface& isosurface, const SimplexMesh& mesh, SimplexVertex v,
                               double tolerance_mm) {
  const SimplexParameters s = simplex_parameters(mesh, v);
  if (s.is_degenerate) return 2 * tolerance_mm;
  return distance_deficit(isosurface, position_of(mesh, v), s.normal, tolerance_mm);
}

double centre_distance_deficit(const Isosurface& isosurface, const SimplexMesh& mesh, SimplexFace f,
                               double tolerance_mm) {
  const Vec3 centre = face_centre(mesh, f);
  Vec3 normal;
  for_each_vertex(mesh, f, [&](SimplexVertex v) {
    normal += cross(position_of(mesh, v) - centre, position_of(mesh, next_around(mesh, v, f)) - centre);
  });
  if (squared_norm(normal) == 0) return 2 * tolerance_mm;
  return distance_deficit(isosurface, centre, normalized(normal), tolerance_mm);
}

}  // namespace periost
