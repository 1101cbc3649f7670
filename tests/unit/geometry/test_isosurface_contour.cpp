// Border queries against an exhaustive search, in an oblique, anisotropic, left-handed grid.
#include "pipeline/geometry/isosurface_contour.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "pipeline/base/random.h"
#include "pipeline/geometry/isosurface_cut.h"
#include "stages/marching_cubes/marching_cubes.h"

namespace periost {
namespace {

Isosurface open_ball() {
  const double c = std::cos(0.5), s = std::sin(0.5);
  Image image{{{16, 14, 12}, {0.7, 1.1, 1.9}, {-31, 12, 55}, {{Vec3{c, s, 0}, {-s, c, 0}, {0, 0, -1}}}}, {}};
  const Vec3 centre = image.frame.to_lps({2, 6.3, 5.1});
  for (std::int32_t k = 0; k < 12; ++k) {
    for (std::int32_t j = 0; j < 14; ++j) {
      for (std::int32_t i = 0; i < 16; ++i) {
        const Vec3 p = image.frame.to_lps({double(i), double(j), double(k)});
        image.values.push_back(static_cast<float>(5.2 - distance(p, centre)));
      }
    }
  }
  return marching_cubes(image, {.lower = 0}, {.open = true}, Context());
}

struct Side {
  Vec3 a, b;
};

std::vector<Side> border(const Isosurface& isosurface, const std::vector<std::uint8_t>& open) {
  std::vector<Side> sides;
  for (std::size_t t = 0; t < open.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      if ((open[t] >> k & 1) == 0) continue;
      const Triangle& corners = isosurface.surface.triangles[t];
      sides.push_back(
          {isosurface.surface.points[corners[(k + 1) % 3]], isosurface.surface.points[corners[(k + 2) % 3]]});
    }
  }
  return sides;
}

double distance_to(const Side& side, Vec3 p) {
  const double t = dot(p - side.a, side.b - side.a) / squared_norm(side.b - side.a);
  return distance(p, side.a + std::clamp(t, 0.0, 1.0) * (side.b - side.a));
}

TEST(IsosurfaceContour, OpenSidesFormClosedCurvesOnTheBorderPlane) {
  const Isosurface ball = open_ball();
  const auto sides = border(ball, open_sides(ball.surface));
  ASSERT_GT(sides.size(), 10u);
  for (const Side& side : sides) {
    EXPECT_NEAR(ball.frame.to_index(side.a).x, 0, 1e-9);
    // Every side is followed by one: the border runs in one direction.
    EXPECT_EQ(std::count_if(sides.begin(), sides.end(), [&](const Side& s) { return s.a == side.b; }), 1);
  }
  EXPECT_TRUE(open_sides(merge_isosurfaces({ball}).surface).size() == ball.surface.triangles.size());
}

TEST(IsosurfaceContour, FindsTheClosestPointAmongSidesOfADirection) {
  const Isosurface ball = open_ball();
  const auto open = open_sides(ball.surface);
  const auto sides = border(ball, open);
  Random random(11, 0);
  int found = 0;
  for (int n = 0; n < 600; ++n) {
    const Vec3 p =
        ball.frame.to_lps({random.uniform() * 3 - 1.5, random.uniform() * 16 - 1, random.uniform() * 14 - 1});
    const Vec3 direction =
        n % 3 == 0 ? Vec3{} : Vec3{random.uniform() - 0.5, random.uniform() - 0.5, random.uniform() - 0.5};
    const double within = 0.2 + 2 * random.uniform();
    double expected = std::numeric_limits<double>::infinity();
    for (const Side& side : sides) {
      if (direction != Vec3{} && !(dot(side.b - side.a, direction) > 0)) continue;
      expected = std::min(expected, distance_to(side, p));
    }
    const auto closest = closest_on_contour(ball, open, p, direction, within);
    ASSERT_EQ(closest.has_value(), expected <= within);
    if (!closest) continue;
    ++found;
    EXPECT_NEAR(closest->distance, expected, 1e-12);
    EXPECT_NEAR(distance(closest->point, p), closest->distance, 1e-12);
    EXPECT_NEAR(norm(closest->direction), 1, 1e-12);
    EXPECT_TRUE(direction == Vec3{} || dot(closest->direction, direction) > 0);
  }
  EXPECT_GT(found, 50);
}

TEST(IsosurfaceContour, AClosedSurfaceHasNone) {
  Isosurface ball = open_ball();
  EXPECT_FALSE(closest_on_contour(ball, {}, ball.surface.points[0], {}, 100));
  EXPECT_FALSE(closest_on_contour(ball, open_sides(ball.surface), {1e30, -1e30, 1e30}, {}, 1));
}

}  // namespace
}  // namespace periost
