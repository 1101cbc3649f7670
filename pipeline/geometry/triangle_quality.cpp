#include "pipeline/geometry/triangle_quality.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace periost {
namespace {

double angle_deg(Vec3 u, Vec3 v) {
  return std::atan2(norm(cross(u, v)), dot(u, v)) * 180 / std::numbers::pi;
}

}  // namespace

double triangle_min_angle_deg(Vec3 a, Vec3 b, Vec3 c) {
  // Two equal corners leave one angle undefined and another 90 degrees; the triangle is degenerate all the
  // same.
  if (a == b || b == c || c == a) return 0;
  return std::min({angle_deg(b - a, c - a), angle_deg(c - b, a - b), angle_deg(a - c, b - c)});
}

double triangle_radius_ratio(Vec3 a, Vec3 b, Vec3 c) {
  const double l0 = distance(b, c), l1 = distance(c, a), l2 = distance(a, b);
  const double doubled_area = norm(cross(b - a, c - a));
  const double ratio = l0 * l1 * l2 * (l0 + l1 + l2) / (4 * doubled_area * doubled_area);
  return ratio < kUnboundedMetric ? ratio : kUnboundedMetric;
}

}  // namespace periost
