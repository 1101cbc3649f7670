#include "stages/phantom/body.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pipeline/base/random.h"

namespace periost {
namespace {

// The larger of two depths, rounded off where they are within `blend` of each other.
double blended_max(double a, double b, double blend) {
  const double larger = std::max(a, b);
  const double overlap = blend - std::abs(a - b);
  return overlap > 0 ? larger + overlap * overlap / (4 * blend) : larger;
}

// Whether a value lies within `reach` of the span of a cone along an axis.
bool is_near(const RoundCone& cone, std::size_t axis, double value, double reach) {
  const auto [low, high] = std::minmax({cone.a[axis], cone.b[axis]});
  return value > low - reach && value < high + reach;
}

double lattice_value(std::uint64_t seed, std::int64_t x, std::int64_t y, std::int64_t z) {
  constexpr std::int64_t kOffset = 1 << 20;
  const auto part = [](std::int64_t v) { return static_cast<std::uint64_t>(v + kOffset) & 0x1FFFFF; };
  return 2 * Random(seed, part(x) | part(y) << 21 | part(z) << 42).uniform() - 1;
}

}  // namespace

double depth_in(const RoundCone& cone, Vec3 p) {
  const Vec3 axis = cone.b - cone.a;
  const double length_squared = squared_norm(axis);
  const double t = length_squared > 0 ? std::clamp(dot(p - cone.a, axis) / length_squared, 0.0, 1.0) : 0.0;
  return cone.radius_a + t * (cone.radius_b - cone.radius_a) - distance(p, cone.a + axis * t);
}

void depths_on_line(const Body& body, const Line& line, double margin, std::vector<double>& depths) {
  constexpr double kFarOutside = -1e9;
  std::fill(depths.begin(), depths.end(), kFarOutside);
  const auto last = static_cast<double>(depths.size()) - 1;
  for (const RoundCone& cone : body.cones) {
    const double reach = std::max(cone.radius_a, cone.radius_b) + margin + body.blend;
    if (!is_near(cone, 1, line.y, reach) || !is_near(cone, 2, line.z, reach)) continue;
    const auto [low, high] = std::minmax({cone.a.x, cone.b.x});
    const double begin = std::clamp(std::ceil((low - reach - line.x0) / line.dx), 0.0, last + 1);
    const double end = std::clamp(std::floor((high + reach - line.x0) / line.dx), -1.0, last) + 1;
    for (auto n = static_cast<std::size_t>(begin); n < static_cast<std::size_t>(end); ++n) {
      const double d = depth_in(cone, line.point(n));
      depths[n] = body.blend > 0 ? blended_max(depths[n], d, body.blend) : std::max(depths[n], d);
    }
  }
}

double smooth_noise(std::uint64_t seed, Vec3 p) {
  const auto ramp = [](double t) { return t * t * (3 - 2 * t); };
  const Vec3 cell{std::floor(p.x), std::floor(p.y), std::floor(p.z)};
  const auto x = static_cast<std::int64_t>(cell.x);
  const auto y = static_cast<std::int64_t>(cell.y);
  const auto z = static_cast<std::int64_t>(cell.z);
  const double u = ramp(p.x - cell.x);
  const double v = ramp(p.y - cell.y);
  const double w = ramp(p.z - cell.z);
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const int a = corner & 1;
    const int b = corner >> 1 & 1;
    const int c = corner >> 2;
    sum += (a != 0 ? u : 1 - u) * (b != 0 ? v : 1 - v) * (c != 0 ? w : 1 - w) *
           lattice_value(seed, x + a, y + b, z + c);
  }
  return sum;
}

}  // namespace periost
