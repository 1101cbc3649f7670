#include "stages/decimate/contour_model.h"

#include <algorithm>

#include "pipeline/geometry/isosurface_contour.h"
#include "pipeline/geometry/simplex_operators.h"

namespace periost {
namespace {

std::uint8_t side_of(const ContourModel& model, SimplexVertex v) {
  return model.contours.empty() ? kInside : model.contours.side[index_of(v)];
}

// Where v's contour goes towards neighbour k (0 or 1): that neighbour, or the corner between the two planes.
Vec3 contour_neighbour(const ContourModel& model, const SimplexMesh& mesh, SimplexVertex v, int k) {
  const SimplexVertex w = neighbour_of(mesh, v, k);
  if (side_of(model, w) == side_of(model, v)) return position_of(mesh, w);
  return mesh.dual_position[index_of(face_of(mesh, v, 1 - k))];
}

double deficit_on_contour(const ContourModel& model, Vec3 p, Vec3 direction, double tolerance_mm) {
  const auto closest = closest_on_contour(model.isosurface, model.open, p, direction, 3 * tolerance_mm);
  return closest ? std::max(0.0, closest->distance - tolerance_mm) : 2 * tolerance_mm;
}

}  // namespace

ContourModel contour_model(const Isosurface& isosurface, const Contours& contours) {
  ContourModel model{isosurface, contours, {}};
  if (!contours.empty()) model.open = open_sides(isosurface.surface);
  return model;
}

bool is_border_face(const ContourModel& model, const SimplexMesh& mesh, SimplexFace f) {
  return !model.contours.is_over_hole(f) && contour_edge_of(mesh, model.contours, f).exists();
}

bool is_pinned(const ContourModel& model, const SimplexMesh& mesh, SimplexFace f) {
  if (model.contours.is_over_hole(f)) return true;
  const ContourEdge edge = contour_edge_of(mesh, model.contours, f);
  if (!edge.exists()) return false;
  const std::uint8_t first = side_of(model, edge.first);
  return first == kFixedContour || first != side_of(model, edge.second);
}

bool is_on_fixed_contour(const ContourModel& model, const SimplexMesh& mesh, SimplexFace f) {
  if (model.contours.is_over_hole(f)) return false;
  const ContourEdge edge = contour_edge_of(mesh, model.contours, f);
  return edge.exists() &&
         (side_of(model, edge.first) == kFixedContour || side_of(model, edge.second) == kFixedContour);
}

Vec3 dual_place(const ContourModel& model, const SimplexMesh& mesh, SimplexFace f) {
  if (is_pinned(model, mesh, f)) return mesh.dual_position[index_of(f)];
  const ContourEdge edge = contour_edge_of(mesh, model.contours, f);
  if (!edge.exists()) return face_centre(mesh, f);
  return 0.5 * (position_of(mesh, edge.first) + position_of(mesh, edge.second));
}

Vec3 contour_direction(const ContourModel& model, const SimplexMesh& mesh, SimplexVertex v) {
  return contour_neighbour(model, mesh, v, 1) - contour_neighbour(model, mesh, v, 0);
}

Vec3 contour_normal(const ContourModel& model, std::uint8_t side, Vec3 direction) {
  const Vec3 axis = model.isosurface.frame.direction.column[side / 2u];
  const Vec3 out_of_the_image = side % 2 == 0 ? -axis : axis;
  return normalized(cross(out_of_the_image, direction));
}

SimplexParameters contour_parameters(const ContourModel& model, const SimplexMesh& mesh, SimplexVertex v) {
  const Vec3 p = position_of(mesh, v), a = contour_neighbour(model, mesh, v, 0),
             b = contour_neighbour(model, mesh, v, 1);
  const Vec3 along = b - a;
  const double length2 = squared_norm(along);
  SimplexParameters result;
  if (!(length2 > 1e-20 * (squared_norm(p - a) + squared_norm(p - b)))) {
    result.is_degenerate = true;
    return result;
  }
  const double t = dot(p - a, along) / length2;
  result.barycentric = {1 - t, t, 0};
  result.normal = contour_normal(model, side_of(model, v), along);
  result.height = dot(p - a, result.normal);
  result.foot = p - result.height * result.normal;
  result.power = t * (1 - t) * length2;
  result.circumradius = 0.5 * std::sqrt(length2);
  return result;
}

Vec3 on_border_plane(const GridFrame& frame, std::uint8_t side, Vec3 p) {
  const std::size_t axis = side / 2;
  const Vec3 normal = frame.direction.column[axis];
  const double plane = side % 2 == 0 ? 0 : (frame.dims[axis] - 1) * frame.spacing[axis];
  return p - (dot(p - frame.origin, normal) - plane) * normal;
}

double barycentric_deficit(const ContourModel& model, const SimplexMesh& mesh, SimplexVertex v,
                           double least) {
  const std::uint8_t side = side_of(model, v);
  if (side == kInside) return barycentric_deficit(mesh, v, least);
  if (side == kFixedContour) return 0;
  const SimplexParameters s = contour_parameters(model, mesh, v);
  if (s.is_degenerate) return 1;
  return std::max(0.0, least - s.barycentric[0]) + std::max(0.0, least - s.barycentric[1]);
}

double distance_deficit(const ContourModel& model, const SimplexMesh& mesh, SimplexVertex v,
                        double tolerance_mm) {
  const std::uint8_t side = side_of(model, v);
  if (side == kInside) return vertex_distance_deficit(model.isosurface, mesh, v, tolerance_mm);
  if (side == kFixedContour) return 0;
  return deficit_on_contour(model, position_of(mesh, v), contour_direction(model, mesh, v), tolerance_mm);
}

double centre_deficit(const ContourModel& model, const SimplexMesh& mesh, SimplexFace f,
                      double tolerance_mm) {
  if (is_pinned(model, mesh, f)) return 0;
  const ContourEdge edge = contour_edge_of(mesh, model.contours, f);
  if (!edge.exists()) return centre_distance_deficit(model.isosurface, mesh, f, tolerance_mm);
  const Vec3 a = position_of(mesh, edge.first), b = position_of(mesh, edge.second);
  return deficit_on_contour(model, 0.5 * (a + b), b - a, tolerance_mm);
}

Deficits measure_deficits(const ContourModel& model, const SimplexMesh& mesh, const Criteria& criteria) {
  Deficits deficits;
  deficits.barycentric.resize(mesh.face.size());
  deficits.distance.resize(mesh.face.size());
  deficits.centre.resize(mesh.valence.size());
  for (std::uint32_t i = 0; i < mesh.face.size(); ++i) {
    const SimplexVertex v{i};
    deficits.barycentric[i] = barycentric_deficit(model, mesh, v, criteria.min_barycentric);
    deficits.distance[i] = distance_deficit(model, mesh, v, criteria.distance_mm);
  }
  for (std::uint32_t f = 0; f < mesh.valence.size(); ++f) {
    deficits.centre[f] = centre_deficit(model, mesh, SimplexFace{f}, criteria.distance_mm);
  }
  return deficits;
}

std::uint32_t crowding(const ContourModel& model, const SimplexMesh& mesh, SimplexFace f) {
  const std::uint32_t valence = valence_of(mesh, f);
  if (!is_border_face(model, mesh, f)) return valence;
  return is_on_fixed_contour(model, mesh, f) ? 2 * (valence - 2) : valence + 1;
}

int topological_criterion(const ContourModel& model, const SimplexMesh& mesh, SimplexEdge edge) {
  if (model.contours.empty()) return topological_criterion(mesh, edge);
  const EdgeFaces f = faces_of(mesh, edge);
  for (const SimplexFace face : {f.left, f.right, f.opposite_v, f.opposite_w}) {
    if (model.contours.is_over_hole(face)) return 0;
  }
  const auto valence = [&](SimplexFace face) { return static_cast<int>(crowding(model, mesh, face)); };
  return valence(f.left) + valence(f.right) - valence(f.opposite_v) - valence(f.opposite_w);
}

}  // namespace periost
