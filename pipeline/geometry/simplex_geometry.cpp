#include "pipeline/geometry/simplex_geometry.h"

#include <algorithm>
#include <cmath>

#include "pipeline/geometry/simplex_walk.h"

namespace periost {

SimplexParameters simplex_parameters(Vec3 p, const std::array<Vec3, 3>& neighbours) {
  const Vec3 a = neighbours[0], b = neighbours[1], c = neighbours[2];
  const Vec3 ab = b - a, ac = c - a, bc = c - b;
  const Vec3 twice_area = cross(ab, ac);
  const double area2 = squared_norm(twice_area);
  const double l12 = squared_norm(ab), l13 = squared_norm(ac), l23 = squared_norm(bc);
  const double longest = std::max({l12, l13, l23});
  SimplexParameters result;
  // Sine of the smallest angle below about 1e-10: the plane of the neighbours is not known.
  if (!(area2 > 1e-20 * longest * longest)) {
    result.is_degenerate = true;
    return result;
  }
  const double area = std::sqrt(area2);
  result.normal = twice_area / area;
  result.height = dot(p - a, result.normal);
  result.foot = p - result.height * result.normal;
  const Vec3 from_a = result.foot - a, from_b = result.foot - b, from_c = result.foot - c;
  result.barycentric = {dot(cross(from_b, from_c), result.normal) / area,
                        dot(cross(from_c, from_a), result.normal) / area,
                        dot(cross(from_a, from_b), result.normal) / area};
  const auto& e = result.barycentric;
  result.power = e[0] * e[1] * l12 + e[1] * e[2] * l23 + e[0] * e[2] * l13;
  result.circumradius = std::sqrt(l12 * l13 * l23) / (2 * area);
  return result;
}

SimplexParameters simplex_parameters(const SimplexMesh& mesh, SimplexVertex v) {
  const auto& around = mesh.neighbour[index_of(v)];
  return simplex_parameters(position_of(mesh, v), {position_of(mesh, around[0]), position_of(mesh, around[1]),
                                                   position_of(mesh, around[2])});
}

double simplex_angle(const SimplexParameters& parameters) {
  const double h = parameters.height, power = parameters.power;
  const double cosine = power >= 0 ? power - h * h : -power + h * h;
  return std::atan2(2 * parameters.circumradius * h, cosine);
}

double height_at_angle(double angle, double power, double circumradius) {
  const double s = std::sin(angle), rc = circumradius * std::cos(angle);
  const double root = std::sqrt(std::max(0.0, rc * rc + power * s * s));
  // Past a right angle the sum in the denominator cancels; its conjugate does not.
  if (power > 0 && rc < 0 && s != 0) return (root - rc) / s;
  const double below = rc + root;
  return below == 0 ? 0 : std::abs(power) * s / below;
}

}  // namespace periost
