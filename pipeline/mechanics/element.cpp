#include "pipeline/mechanics/element.h"

#include <cmath>

#include "pipeline/base/error.h"
#include "pipeline/geometry/tet_faces.h"

namespace periost {
namespace {

using Barycentric = std::array<double, 4>;

struct RulePoint {
  Barycentric at;
  double weight;  // of a rule whose weights add up to 1
};

template <std::size_t N>
using Rule = std::array<RulePoint, N>;

// Four points of degree 2.
Rule<4> rule_of_degree_2() {
  const double near = (5 + 3 * std::sqrt(5.0)) / 20, far = (5 - std::sqrt(5.0)) / 20;
  Rule<4> rule{};
  for (std::size_t i = 0; i < 4; ++i) {
    rule[i].at.fill(far);
    rule[i].at[i] = near;
    rule[i].weight = 0.25;
  }
  return rule;
}

// Fourteen points of degree 5: two orbits of four towards the corners, one of six towards the edges.
Rule<14> rule_of_degree_5() {
  constexpr double kNear[2] = {0.0927352503108912264, 0.310885919263300610};
  constexpr double kCornerWeight[2] = {0.0734930431163619495, 0.112687925718015851};
  constexpr double kEdge = 0.0455037041256496495, kEdgeWeight = 0.0425460207770814668;
  Rule<14> rule{};
  std::size_t next = 0;
  for (std::size_t orbit = 0; orbit < 2; ++orbit) {
    for (std::size_t i = 0; i < 4; ++i, ++next) {
      rule[next].at.fill(kNear[orbit]);
      rule[next].at[i] = 1 - 3 * kNear[orbit];
      rule[next].weight = kCornerWeight[orbit];
    }
  }
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = i + 1; j < 4; ++j, ++next) {
      rule[next].at.fill(kEdge);
      rule[next].at[i] = rule[next].at[j] = 0.5 - kEdge;
      rule[next].weight = kEdgeWeight;
    }
  }
  return rule;
}

// Gradients of the four barycentric coordinates of a mapping whose derivatives by the last three are a, b, c,
// and six times the volume that these span.
struct LinearMap {
  std::array<Vec3, 4> gradient;
  double determinant;
};

LinearMap linear_map(Vec3 a, Vec3 b, Vec3 c) {
  LinearMap map{};
  const Vec3 bc = cross(b, c), ca = cross(c, a), ab = cross(a, b);
  map.determinant = dot(a, bc);
  map.gradient = {-(bc + ca + ab) / map.determinant, bc / map.determinant, ca / map.determinant,
                  ab / map.determinant};
  return map;
}

// Gradients of the quadratic shape functions l_i (2 l_i - 1) and 4 l_i l_j, given those of the l.
std::array<Vec3, 10> quadratic_gradients(const Barycentric& l, const std::array<Vec3, 4>& gradient) {
  std::array<Vec3, 10> result;
  for (std::size_t i = 0; i < 4; ++i) result[i] = (4 * l[i] - 1) * gradient[i];
  for (std::size_t e = 0; e < 6; ++e) {
    const auto i = static_cast<std::size_t>(kTetEdge[e][0]), j = static_cast<std::size_t>(kTetEdge[e][1]);
    result[4 + e] = 4 * (l[i] * gradient[j] + l[j] * gradient[i]);
  }
  return result;
}

bool has_straight_edges(std::span<const Vec3> nodes) {
  constexpr double kRoundingOfMiddles = 1e-10;
  for (std::size_t e = 0; e < 6; ++e) {
    const Vec3 a = nodes[static_cast<std::size_t>(kTetEdge[e][0])];
    const Vec3 b = nodes[static_cast<std::size_t>(kTetEdge[e][1])];
    if (!(distance(nodes[4 + e], 0.5 * (a + b)) <= kRoundingOfMiddles * distance(a, b))) return false;
  }
  return true;
}

// The mapping at one point of a curved element.
LinearMap curved_map(std::span<const Vec3> nodes, const Barycentric& l) {
  static constexpr std::array<Vec3, 4> kReference{Vec3{-1, -1, -1}, Vec3{1, 0, 0}, Vec3{0, 1, 0},
                                                  Vec3{0, 0, 1}};
  const auto derivative = quadratic_gradients(l, kReference);
  Vec3 a, b, c;
  for (std::size_t k = 1; k < 10; ++k) {  // from the first node, so that a far origin costs no digits
    const Vec3 node = nodes[k] - nodes[0];
    a += derivative[k].x * node;
    b += derivative[k].y * node;
    c += derivative[k].z * node;
  }
  return linear_map(a, b, c);
}

void add_point(ElementShape& shape, const RulePoint& rule, const LinearMap& map) {
  IntegrationPoint& point = shape.at[shape.points++];
  point.volume = rule.weight * map.determinant / 6;
  point.gradient = quadratic_gradients(rule.at, map.gradient);
}

}  // namespace

LameConstants lame_constants(const Material& material) {
  const double e = material.young_mpa, nu = material.poisson;
  return {e * nu / ((1 + nu) * (1 - 2 * nu)), e / (2 * (1 + nu))};
}

ElementShape element_shape(std::span<const Vec3> nodes) {
  static const Rule<4> kStraight = rule_of_degree_2();
  static const Rule<14> kCurved = rule_of_degree_5();
  PERIOST_ASSERT(nodes.size() == 4 || nodes.size() == 10);
  ElementShape shape;
  shape.nodes = nodes.size();
  const LinearMap corners = linear_map(nodes[1] - nodes[0], nodes[2] - nodes[0], nodes[3] - nodes[0]);
  if (nodes.size() == 4) {
    shape.points = 1;
    shape.at[0].volume = corners.determinant / 6;
    for (std::size_t k = 0; k < 4; ++k) shape.at[0].gradient[k] = corners.gradient[k];
  } else if (has_straight_edges(nodes)) {
    for (const RulePoint& rule : kStraight) add_point(shape, rule, corners);
  } else {
    for (const RulePoint& rule : kCurved) add_point(shape, rule, curved_map(nodes, rule.at));
  }
  return shape;
}

ElementShape element_shape(const TetMesh& mesh, std::size_t tet) {
  std::array<Vec3, 10> nodes;
  const std::size_t count = nodes_per_tet(mesh);
  for (std::size_t k = 0; k < count; ++k) nodes[k] = mesh.points[tet_node(mesh, tet, k)];
  return element_shape(std::span<const Vec3>(nodes.data(), count));
}

bool is_regular(const ElementShape& shape) {
  for (std::size_t p = 0; p < shape.points; ++p) {
    if (!(shape.at[p].volume > 0)) return false;
  }
  return true;
}

Block stiffness_block(const ElementShape& shape, const LameConstants& lame, std::size_t i, std::size_t j) {
  Block block{};
  for (std::size_t p = 0; p < shape.points; ++p) {
    const Vec3 gi = shape.at[p].gradient[i], gj = shape.at[p].gradient[j];
    const double lambda = lame.lambda * shape.at[p].volume, mu = lame.mu * shape.at[p].volume;
    const double shear = mu * dot(gi, gj);
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t b = 0; b < 3; ++b) {
        block[3 * a + b] += lambda * (gi[a] * gj[b]) + mu * (gi[b] * gj[a]) + (a == b ? shear : 0);
      }
    }
  }
  return block;
}

Stress stress_at(const IntegrationPoint& point, const LameConstants& lame,
                 std::span<const Vec3> displacement) {
  Vec3 dx, dy, dz;  // derivatives of the displacement
  for (std::size_t k = 0; k < displacement.size(); ++k) {
    dx += point.gradient[k].x * displacement[k];
    dy += point.gradient[k].y * displacement[k];
    dz += point.gradient[k].z * displacement[k];
  }
  const double pressure = lame.lambda * (dx.x + dy.y + dz.z), mu = lame.mu;
  return {pressure + 2 * mu * dx.x, pressure + 2 * mu * dy.y, pressure + 2 * mu * dz.z,
          mu * (dx.y + dy.x),       mu * (dy.z + dz.y),       mu * (dz.x + dx.z)};
}

double von_mises(const Stress& s) {
  const double xy = s[0] - s[1], yz = s[1] - s[2], zx = s[2] - s[0];
  return std::sqrt(0.5 * (xy * xy + yz * yz + zx * zx) + 3 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]));
}

}  // namespace periost
