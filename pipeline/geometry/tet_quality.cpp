#include "pipeline/geometry/tet_quality.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "pipeline/geometry/triangle_quality.h"

namespace periost {
namespace {

// Area vectors of the faces opposite to each corner, outward for a positive volume.
std::array<Vec3, 4> face_vectors(const TetCorners& t) {
  return {0.5 * cross(t[2] - t[1], t[3] - t[1]), 0.5 * cross(t[3] - t[0], t[2] - t[0]),
          0.5 * cross(t[1] - t[0], t[3] - t[0]), 0.5 * cross(t[2] - t[0], t[1] - t[0])};
}

double area_sum(const TetCorners& t) {
  double sum = 0;
  for (const Vec3& face : face_vectors(t)) sum += norm(face);
  return sum;
}

constexpr std::array<std::pair<std::size_t, std::size_t>, 6> kEdges{
    {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}};

double bounded(double ratio) {
  return ratio < kUnboundedMetric ? ratio : kUnboundedMetric;
}

// The determinant of the isoparametric mapping of a second-order tetrahedron at barycentric coordinates l
// (l[0] belongs to corner 0); the Jacobian's columns are the derivatives by l1, l2, l3 with l0 = 1 - l1 - l2
// - l3.
double jacobian_at(const Tet10Nodes& t, const std::array<double, 4>& l) {
  // d/dl_i of the quadratic shape functions l_i (2 l_i - 1) and 4 l_i l_j.
  std::array<Vec3, 4> derivative;
  for (std::size_t i = 0; i < 4; ++i) derivative[i] = t[i] * (4 * l[i] - 1);
  for (std::size_t e = 0; e < 6; ++e) {
    const auto [i, j] = kEdges[e];
    derivative[i] += t[4 + e] * (4 * l[j]);
    derivative[j] += t[4 + e] * (4 * l[i]);
  }
  return dot(derivative[1] - derivative[0],
             cross(derivative[2] - derivative[0], derivative[3] - derivative[0]));
}

// Barycentric coordinates where the mapping is looked at: corners, mid-side nodes, Gauss points.
std::array<std::array<double, 4>, 14> jacobian_points() {
  std::array<std::array<double, 4>, 14> points{};
  const double near = (5 + 3 * std::sqrt(5.0)) / 20, far = (5 - std::sqrt(5.0)) / 20;
  for (std::size_t i = 0; i < 4; ++i) {
    points[i][i] = 1;
    points[10 + i].fill(far);
    points[10 + i][i] = near;
  }
  for (std::size_t e = 0; e < 6; ++e) {
    points[4 + e][kEdges[e].first] = 0.5;
    points[4 + e][kEdges[e].second] = 0.5;
  }
  return points;
}

}  // namespace

TetCorners tet_corners(const TetMesh& mesh, std::size_t t) {
  const auto& [a, b, c, d] = mesh.tets[t];
  return {mesh.points[a], mesh.points[b], mesh.points[c], mesh.points[d]};
}

Tet10Nodes tet10_nodes(const TetMesh& mesh, std::size_t t) {
  Tet10Nodes nodes;
  for (std::size_t i = 0; i < 4; ++i) nodes[i] = mesh.points[mesh.tets[t][i]];
  for (std::size_t i = 0; i < 6; ++i) nodes[4 + i] = mesh.points[mesh.midside[t][i]];
  return nodes;
}

double tet_volume(const TetCorners& t) {
  return dot(t[1] - t[0], cross(t[2] - t[0], t[3] - t[0])) / 6;
}

DihedralRange tet_dihedral_range(const TetCorners& t) {
  const std::array<Vec3, 4> faces = face_vectors(t);
  DihedralRange range{180, 0};
  for (std::size_t i = 0; i < 4; ++i) {
    if (squared_norm(faces[i]) == 0) return {0, 180};
    for (std::size_t j = i + 1; j < 4; ++j) {
      const double angle = std::atan2(norm(cross(faces[i], faces[j])), -dot(faces[i], faces[j]));
      range.min_deg = std::min(range.min_deg, angle * 180 / std::numbers::pi);
      range.max_deg = std::max(range.max_deg, angle * 180 / std::numbers::pi);
    }
  }
  return range;
}

double tet_radius_ratio(const TetCorners& t) {
  const double volume = tet_volume(t);
  if (!(volume > 0)) return kUnboundedMetric;
  const Vec3 a = t[1] - t[0], b = t[2] - t[0], c = t[3] - t[0];
  // R = |...| / (12 V) and r = 3 V / (sum of areas).
  const double twelve_rv =
      norm(squared_norm(a) * cross(b, c) + squared_norm(b) * cross(c, a) + squared_norm(c) * cross(a, b));
  return bounded(twelve_rv * area_sum(t) / (108 * volume * volume));
}

double tet_scaled_jacobian(const TetCorners& t) {
  double largest = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    double product = 1;
    for (std::size_t j = 0; j < 4; ++j) {
      if (j != i) product *= distance(t[i], t[j]);
    }
    largest = std::max(largest, product);
  }
  return largest > 0 ? std::numbers::sqrt2 * 6 * tet_volume(t) / largest : 0;
}

double tet_mean_ratio(const TetCorners& t) {
  const double volume = tet_volume(t);
  if (!(volume > 0)) return 0;
  double squares = 0;
  for (const auto& [i, j] : kEdges) squares += squared_norm(t[j] - t[i]);
  return 12 * std::cbrt(9 * volume * volume) / squares;
}

double tet_aspect_ratio(const TetCorners& t) {
  const double volume = tet_volume(t);
  if (!(volume > 0)) return kUnboundedMetric;
  double longest = 0;
  for (const auto& [i, j] : kEdges) longest = std::max(longest, distance(t[i], t[j]));
  const double inradius = 3 * volume / area_sum(t);
  return bounded(longest / (2 * std::sqrt(6.0) * inradius));
}

double tet_size_ratio(double volume_a, double volume_b) {
  const double a = std::abs(volume_a), b = std::abs(volume_b);
  const double smaller = std::min(a, b);
  return smaller > 0 ? bounded(std::cbrt(std::max(a, b) / smaller)) : kUnboundedMetric;
}

double tet10_jacobian_ratio(const Tet10Nodes& t) {
  static const auto kPoints = jacobian_points();
  double smallest = 0, largest = 0;
  for (std::size_t i = 0; i < kPoints.size(); ++i) {
    const double jacobian = jacobian_at(t, kPoints[i]);
    smallest = i == 0 ? jacobian : std::min(smallest, jacobian);
    largest = std::max(largest, std::abs(jacobian));
  }
  return largest > 0 ? smallest / largest : 0;
}

double tet10_min_corner_jacobian(const Tet10Nodes& t) {
  static const auto kPoints = jacobian_points();
  double smallest = jacobian_at(t, kPoints[0]);
  for (std::size_t i = 1; i < 4; ++i) smallest = std::min(smallest, jacobian_at(t, kPoints[i]));
  return smallest;
}

}  // namespace periost
