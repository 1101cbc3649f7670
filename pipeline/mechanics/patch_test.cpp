#include "pipeline/mechanics/patch_test.h"

#include <algorithm>

#include "pipeline/geometry/tet_faces.h"
#include "pipeline/mechanics/solver.h"

namespace periost {
namespace {

// Gradient of the prescribed field: no symmetry, no zero.
constexpr Mat3 kGradient{{Vec3{1.0, 0.3, -0.2}, Vec3{-0.5, -0.7, 0.4}, Vec3{0.6, 0.1, 0.8}}};

Vec3 middle_of(const std::vector<Vec3>& points) {
  if (points.empty()) return {};
  Vec3 low = points.front(), high = low;
  for (const Vec3& p : points) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], p[axis]);
      high[axis] = std::max(high[axis], p[axis]);
    }
  }
  return 0.5 * (low + high);
}

}  // namespace

std::vector<bool> boundary_nodes(const TetMesh& mesh) {
  std::vector<bool> is_on_boundary(mesh.points.size(), false);
  for (const BoundaryFace& face : boundary_faces(tet_neighbours(mesh.tets, mesh.points.size()))) {
    for (int k = 0; k < 4; ++k) {
      if (k != face.opposite) is_on_boundary[mesh.tets[face.tet][static_cast<std::size_t>(k)]] = true;
    }
    for (std::size_t e = 0; e < 6 && mesh.order() == 2; ++e) {
      const bool is_of_face = kTetEdge[e][0] != face.opposite && kTetEdge[e][1] != face.opposite;
      if (is_of_face) is_on_boundary[mesh.midside[face.tet][e]] = true;
    }
  }
  return is_on_boundary;
}

PatchTest patch_test(const TetMesh& mesh, const Stiffness& stiffness, const Context& context) {
  const Vec3 middle = middle_of(mesh.points);
  const auto field = [&](std::size_t node) { return kGradient * (mesh.points[node] - middle); };
  const std::vector<bool> is_on_boundary = boundary_nodes(mesh);
  LoadCase load_case;
  PatchTest result;
  for (Index node = 0; node < mesh.points.size(); ++node) {
    if (!stiffness.is_used(node)) continue;
    if (!is_on_boundary[node]) ++result.free_nodes;
    const Vec3 displacement = field(node);
    for (int axis = 0; axis < 3 && is_on_boundary[node]; ++axis) {
      load_case.supports.push_back({node, axis, displacement[static_cast<std::size_t>(axis)]});
    }
  }
  if (result.free_nodes == 0) return result;
  const Solution solution = solve_iteratively(stiffness, load_case, {.tolerance = 1e-13}, context);
  double largest = 0, error = 0;
  for (std::size_t node = 0; node < mesh.points.size(); ++node) {
    if (!stiffness.is_used(node)) continue;
    largest = std::max(largest, norm(field(node)));
    error = std::max(error, distance(solution.displacement[node], field(node)));
  }
  result.error = error / largest;
  return result;
}

}  // namespace periost
