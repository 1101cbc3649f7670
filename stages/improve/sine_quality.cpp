#include "stages/improve/sine_quality.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "pipeline/geometry/closest_point.h"
#include "pipeline/geometry/tet_faces.h"

namespace periost {
namespace {

constexpr double kSqrt2 = 1.4142135623730951;
constexpr double kActive = 0.03;        // sines this near to the smallest count as smallest
constexpr int kMaxSteps = 6;            // of one climb
constexpr int kMaxHalvings = 4;         // of one step
constexpr double kSmallestGain = 2e-3;  // of one step, else the climb ends
constexpr double kLongestStep = 0.3;    // of the way to the nearest side

}  // namespace

TetFan::TetFan(Vec3 a_, Vec3 b_, Vec3 c_)
    : a(a_),
      b(b_),
      c(c_),
      normal(cross(b_ - a_, c_ - a_)),
      base(squared_norm(normal)),
      ab(squared_norm(b_ - a_)),
      bc(squared_norm(c_ - b_)),
      ca(squared_norm(a_ - c_)) {}

double smallest_sine(const TetFan& fan, Vec3 p) {
  const Vec3 pa = fan.a - p, pb = fan.b - p, pc = fan.c - p;
  const double volume = -dot(pa, fan.normal);
  const double area_a = squared_norm(cross(pb, pc)), area_b = squared_norm(cross(pc, pa)),
               area_c = squared_norm(cross(pa, pb));
  // Each squared l / (N1 N2) with the product of all areas as the common denominator.
  const double to_a = squared_norm(pa), to_b = squared_norm(pb), to_c = squared_norm(pc);
  const double least =
      std::min({fan.ab * area_a * area_b, fan.bc * area_b * area_c, fan.ca * area_c * area_a,
                to_a * fan.base * area_a, to_b * fan.base * area_b, to_c * fan.base * area_c});
  const double areas = fan.base * area_a * area_b * area_c;
  if (!(areas > 0)) return 0;
  const double mean = (fan.ab + fan.bc + fan.ca + to_a + to_b + to_c) / 6;
  // The squared product of the three edges at a corner, where that is largest.
  const double corner = std::max(std::max(fan.ab * fan.ca * to_a, fan.ab * fan.bc * to_b),
                                 std::max(fan.bc * fan.ca * to_c, to_a * to_b * to_c));
  const double cubes =
      std::max(mean * mean * mean / (2 * kCompact * kCompact), corner / (2 * kJacobian * kJacobian));
  return volume * std::sqrt(std::min(least / areas, 1 / cubes));
}

void sines_with_gradients(const TetFan& fan, Vec3 p, SineGradient (&result)[8]) {
  const std::array<Vec3, 3> to{fan.a - p, fan.b - p, fan.c - p};
  const std::array<Vec3, 3> corner{fan.a, fan.b, fan.c};
  const double volume = -dot(to[0], fan.normal), base = std::sqrt(fan.base);
  const std::array<double, 3> side{std::sqrt(fan.bc), std::sqrt(fan.ca), std::sqrt(fan.ab)};
  // Face k lacks corner k; its doubled area and the relative growth of that.
  std::array<double, 3> area;
  std::array<Vec3, 3> growth;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
    const Vec3 normal = cross(to[i], to[j]);
    area[k] = norm(normal);
    growth[k] = cross(corner[i] - corner[j], normal) / (area[k] * area[k]);
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
    // The base's edge opposite to corner k, at order ab, bc, ca.
    const double at_base = side[k] / (base * area[k]);
    SineGradient& below = result[i];
    below.sine = volume * at_base;
    below.gradient = at_base * fan.normal - below.sine * growth[k];
    // The edge from corner k to p.
    const double length = norm(to[k]), at_side = length / (area[i] * area[j]);
    SineGradient& beside = result[3 + k];
    beside.sine = volume * at_side;
    beside.gradient =
        at_side * fan.normal - beside.sine * (to[k] / (length * length) + growth[i] + growth[j]);
  }
  const double mean =
      (fan.ab + fan.bc + fan.ca + squared_norm(to[0]) + squared_norm(to[1]) + squared_norm(to[2])) / 6;
  const double per_volume = kCompact * kSqrt2 / (mean * std::sqrt(mean));
  // The mean grows by (p - a + p - b + p - c) / 3.
  result[6].sine = per_volume * volume;
  result[6].gradient = per_volume * fan.normal + (result[6].sine / (2 * mean)) * (to[0] + to[1] + to[2]);

  // The same with the largest product of the three edges at a corner; `grows` is the relative growth of it.
  std::array<double, 3> squared;
  for (std::size_t k = 0; k < 3; ++k) squared[k] = squared_norm(to[k]);
  double product = squared[0] * squared[1] * squared[2];
  Vec3 grows = -(to[0] / squared[0] + to[1] / squared[1] + to[2] / squared[2]);
  const std::array<double, 3> at_corner{fan.ab * fan.ca, fan.ab * fan.bc, fan.bc * fan.ca};
  for (std::size_t k = 0; k < 3; ++k) {
    if (at_corner[k] * squared[k] <= product) continue;
    product = at_corner[k] * squared[k];
    grows = -(to[k] / squared[k]);
  }
  const double per_corner = kJacobian * kSqrt2 / std::sqrt(product);
  result[7].sine = per_corner * volume;
  result[7].gradient = per_corner * fan.normal - result[7].sine * grows;
}

double smallest_sine(const std::vector<TetFan>& fans, Vec3 p, double floor) {
  double least = 2;
  for (const TetFan& fan : fans) {
    least = std::min(least, smallest_sine(fan, p));
    if (least <= floor) break;
  }
  return least;
}

Vec3 nearest_to_origin(const std::vector<Vec3>& points) {
  std::array<Vec3, 4> simplex{points[0]};
  std::size_t count = 1;
  Vec3 nearest = points[0];
  for (const Vec3& point : points) {
    if (squared_norm(point) < squared_norm(nearest)) simplex[0] = nearest = point;
  }
  for (int round = 0; round < 24; ++round) {
    const Vec3* lowest = &points[0];
    for (const Vec3& point : points) {
      if (dot(point, nearest) < dot(*lowest, nearest)) lowest = &point;
    }
    if (dot(*lowest, nearest) >= squared_norm(nearest) * (1 - 1e-6)) break;
    simplex[count++] = *lowest;
    const Vec3 fresh = *lowest;
    if (count == 4) {  // only what the new point takes part in can be nearer
      const auto side = [&](Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
        return six_volumes(a, b, c, d) * six_volumes(a, b, c, {}) > 0;
      };
      if (side(simplex[0], simplex[1], simplex[2], fresh) &&
          side(simplex[0], simplex[1], fresh, simplex[2]) &&
          side(simplex[1], simplex[2], fresh, simplex[0]) &&
          side(simplex[2], simplex[0], fresh, simplex[1])) {
        return {};
      }
    }
    Vec3 best = nearest;
    std::array<std::size_t, 2> kept{0, 0};
    for (std::size_t i = 0; i + 1 < count; ++i) {
      for (std::size_t j = i; j + 1 < count; ++j) {
        if (i == j && count > 2) continue;
        const Vec3 q = closest_point_on_triangle({}, simplex[i], simplex[j], fresh);
        if (squared_norm(q) < squared_norm(best)) {
          best = q;
          kept = {i, j};
        }
      }
    }
    if (squared_norm(best) >= squared_norm(nearest)) break;
    nearest = best;
    simplex = {simplex[kept[0]], simplex[kept[1]], fresh};
    count = 3;
    if (kept[0] == kept[1]) {
      simplex[1] = fresh;
      count = 2;
    }
  }
  return nearest;
}

// The direction in which all sines near the smallest grow, as a gradient per mm; zero at a maximum. `each`:
// the smallest of every fan at p.
static Vec3 ascent(const std::vector<TetFan>& fans, const std::vector<double>& each, Vec3 p, double sine,
                   Vec3 normal) {
  std::vector<Vec3> gradients;
  for (std::size_t i = 0; i < fans.size(); ++i) {
    if (each[i] > sine + kActive) continue;
    SineGradient all[8];
    sines_with_gradients(fans[i], p, all);
    for (const SineGradient& one : all) {
      if (one.sine <= sine + kActive) gradients.push_back(one.gradient - dot(one.gradient, normal) * normal);
    }
  }
  return gradients.empty() ? Vec3{} : nearest_to_origin(gradients);
}

// As smallest_sine(), and leaves the smallest of every fan where it exceeds the floor.
static double smallest_sines(const std::vector<TetFan>& fans, Vec3 p, double floor,
                             std::vector<double>& each) {
  double least = 2;
  each.clear();
  for (const TetFan& fan : fans) {
    each.push_back(smallest_sine(fan, p));
    least = std::min(least, each.back());
    if (least <= floor) break;
  }
  return least;
}

Vec3 climb(const std::vector<TetFan>& fans, Vec3 p, double target, double& sine, Vec3 normal) {
  if (sine >= target) return p;
  std::vector<double> here, there;
  here.reserve(fans.size());
  there.reserve(fans.size());
  smallest_sines(fans, p, -2, here);
  for (int step = 0; step < kMaxSteps && sine < target; ++step) {
    const Vec3 direction = ascent(fans, here, p, sine, normal);
    const double slope = norm(direction);
    double reach = 1e300;  // no farther than a share of the way to the nearest face opposite
    for (const TetFan& fan : fans) {
      reach = std::min(reach, dot(p - fan.a, fan.normal) / std::sqrt(fan.base));
    }
    double length = kLongestStep * std::abs(reach);
    if (!(slope * length > kSmallestGain)) break;
    const double before = sine;
    for (int halving = 0; halving <= kMaxHalvings; ++halving, length *= 0.5) {
      const Vec3 place = p + (length / slope) * direction;
      const double reached = smallest_sines(fans, place, before, there);
      if (reached <= before) continue;
      p = place;
      sine = reached;
      std::swap(here, there);
      break;
    }
    if (sine < before + kSmallestGain) break;
  }
  return p;
}

}  // namespace periost
