#include "pipeline/geometry/wall_thickness.h"

#include <algorithm>
#include <vector>

#include "pipeline/geometry/closest_point.h"

namespace periost {
namespace {

constexpr double kFacingAway = -0.5;  // greatest product of the normals of a wall's two sides

struct Near {
  Vec3 point, normal;
  double distance;
};

// The triangles that come within `reach` of p, each with its point closest to p.
std::vector<Near> triangles_near(const SurfaceMesh& surface, Vec3 p, double reach) {
  std::vector<Near> found;
  for (const Triangle& t : surface.triangles) {
    const Vec3 a = surface.points[t[0]], b = surface.points[t[1]], c = surface.points[t[2]];
    const auto is_apart = [&](std::size_t k) {
      return std::min({a[k], b[k], c[k]}) > p[k] + reach || std::max({a[k], b[k], c[k]}) < p[k] - reach;
    };
    if (is_apart(0) || is_apart(1) || is_apart(2)) continue;
    const Vec3 point = closest_point_on_triangle(p, a, b, c);
    const double off = distance(p, point);
    if (off <= reach) found.push_back({point, normalized(cross(b - a, c - a)), off});
  }
  return found;
}

}  // namespace

std::optional<double> wall_thickness(const SurfaceMesh& surface, Vec3 p, double within_mm) {
  const std::vector<Near> near = triangles_near(surface, p, within_mm);
  const auto by_distance = [](const Near& a, const Near& b) { return a.distance < b.distance; };
  const auto front = std::min_element(near.begin(), near.end(), by_distance);
  if (front == near.end() || dot(p - front->point, front->normal) > 0) return std::nullopt;
  const Near* back = nullptr;
  for (const Near& other : near) {
    const bool is_behind = dot(other.normal, front->normal) < kFacingAway &&
                           dot(other.point - p, front->normal) <= 0 &&
                           dot(p - other.point, other.normal) <= 0;
    if (is_behind && (back == nullptr || other.distance < back->distance)) back = &other;
  }
  if (back == nullptr) return std::nullopt;
  return distance(front->point, back->point);
}

}  // namespace periost
