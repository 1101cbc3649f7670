#include <gtest/gtest.h>

#include <algorithm>

#include "pipeline/base/random.h"
#include "pipeline/geometry/predicates.h"
#include "tests/support/surfaces.h"

namespace periost {
namespace {

using Corners = TriangleCorners;
__extension__ using Wide = __int128;  // holds the determinants below

TEST(Predicates, OrientationHasVtksSign) {
  EXPECT_EQ(orient2d({0, 0}, {1, 0}, {0, 1}), 1);
  EXPECT_EQ(orient2d({0, 0}, {0, 1}, {1, 0}), -1);
  EXPECT_EQ(orient3d({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}), 1);
  EXPECT_EQ(orient3d({0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 1}), -1);
}

// The sign of the integer determinant is known; the same points far from the origin and scaled by powers of
// two keep it, though the plain double determinant does not.
TEST(Predicates, OrientationIsExactNearThePlane) {
  Random random(3, 0);
  const double ulp = 0x1.0p-44;
  int wrong_in_doubles = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    std::array<std::array<Wide, 3>, 4> grid;
    std::array<Vec3, 4> point;
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::int64_t step = static_cast<std::int64_t>(random.below(1U << 20)) * 3;
        grid[i][k] = step;
        point[i][k] = 100.0 + static_cast<double>(step) * ulp;
      }
    }
    // The last point near the plane of the others: a + (b - a) + (c - a), one grid step off or not at all.
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int64_t off = static_cast<std::int64_t>(random.below(3)) - 1;
      grid[3][k] = grid[1][k] + grid[2][k] - grid[0][k] + off;
      point[3][k] = 100.0 + static_cast<double>(static_cast<std::int64_t>(grid[3][k])) * ulp;
    }
    std::array<std::array<Wide, 3>, 3> m;
    for (std::size_t r = 0; r < 3; ++r) {
      for (std::size_t k = 0; k < 3; ++k) m[r][k] = grid[r + 1][k] - grid[0][k];
    }
    const Wide determinant = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                             m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                             m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
    const int expected = determinant > 0 ? 1 : determinant < 0 ? -1 : 0;
    ASSERT_EQ(orient3d(point[0], point[1], point[2], point[3]), expected) << trial;
    ASSERT_EQ(orient3d(point[1], point[0], point[2], point[3]), -expected) << trial;
    const Vec3 u = point[0] - point[3], v = point[1] - point[3], w = point[2] - point[3];
    wrong_in_doubles += (dot(u, cross(v, w)) > 0) != (-expected > 0) ? 1 : 0;
  }
  EXPECT_GT(wrong_in_doubles, 0) << "the points are too easy";
}

TEST(Predicates, NearlyCollinearPointsOfDecimals) {
  // The products of 0.1-like numbers round; the exact sign is that of the stored doubles.
  EXPECT_EQ(orient2d({0.5, 0.5}, {12, 12}, {24, 24}), 0);
  EXPECT_EQ(orient2d({0.5, std::nextafter(0.5, 1.0)}, {12, 12}, {24, 24}), 1);
  EXPECT_EQ(orient2d({0.5, std::nextafter(0.5, 0.0)}, {12, 12}, {24, 24}), -1);
}

const Corners kUnit{Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}};

TEST(Predicates, SegmentsAndTriangles) {
  EXPECT_TRUE(segment_meets_triangle({0.2, 0.2, -1}, {0.2, 0.2, 1}, kUnit));
  EXPECT_FALSE(segment_meets_triangle({0.2, 0.2, 0.1}, {0.2, 0.2, 1}, kUnit));
  EXPECT_FALSE(segment_meets_triangle({0.8, 0.8, -1}, {0.8, 0.8, 1}, kUnit));
  EXPECT_TRUE(segment_meets_triangle({0.2, 0.2, 0}, {0.2, 0.2, 1}, kUnit)) << "ends in it";
  EXPECT_TRUE(segment_meets_triangle({0, 0, -1}, {0, 0, 1}, kUnit)) << "through a corner";
  EXPECT_TRUE(segment_meets_triangle({0.5, 0, -1}, {0.5, 0, 1}, kUnit)) << "through an edge";
  EXPECT_TRUE(segment_meets_triangle({-1, 0.2, 0}, {2, 0.2, 0}, kUnit)) << "in its plane";
  EXPECT_TRUE(segment_meets_triangle({0.1, 0.1, 0}, {0.2, 0.2, 0}, kUnit)) << "inside it";
  EXPECT_FALSE(segment_meets_triangle({-1, 2, 0}, {2, 2, 0}, kUnit));
  EXPECT_FALSE(segment_meets_triangle({2, 0, 0}, {3, 0, 0}, kUnit)) << "on an edge's line";
  const Corners flat{Vec3{0, 0, 0}, Vec3{2, 2, 2}, Vec3{1, 1, 1}};
  EXPECT_TRUE(segment_meets_triangle({1, 1, 0}, {1, 1, 3}, flat));
  EXPECT_FALSE(segment_meets_triangle({1, 2, 0}, {1, 2, 3}, flat));
}

TEST(Predicates, TrianglesMeetTheSameWayRound) {
  const Corners crossing{Vec3{0.2, 0.2, -1}, Vec3{0.2, 0.2, 1}, Vec3{5, 5, 0}};
  const Corners touching{Vec3{0.25, 0.25, 0}, Vec3{1, 1, 1}, Vec3{1, 0, 1}};
  const Corners above{Vec3{0, 0, 1e-300}, Vec3{1, 0, 1e-300}, Vec3{0, 1, 1e-300}};
  const Corners overlapping{Vec3{0.1, 0.1, 0}, Vec3{2, 0.1, 0}, Vec3{0.1, 2, 0}};
  const Corners inside{Vec3{0.1, 0.1, 0}, Vec3{0.2, 0.1, 0}, Vec3{0.1, 0.2, 0}};
  const Corners beside{Vec3{1, 1, 0}, Vec3{2, 1, 0}, Vec3{1, 2, 0}};
  for (const auto& [other, expected] :
       {std::pair{crossing, true}, std::pair{touching, true}, std::pair{overlapping, true},
        std::pair{inside, true}, std::pair{beside, false}}) {
    for (int turn = 0; turn < 3; ++turn) {
      Corners turned{other[static_cast<std::size_t>(turn)], other[static_cast<std::size_t>((turn + 1) % 3)],
                     other[static_cast<std::size_t>((turn + 2) % 3)]};
      EXPECT_EQ(triangles_meet(kUnit, turned), expected);
      std::swap(turned[0], turned[1]);
      EXPECT_EQ(triangles_meet(turned, kUnit), expected);
    }
  }
  Corners near = above;
  for (Vec3& corner : near) corner.z = 1e-80;
  EXPECT_FALSE(triangles_meet(kUnit, near)) << "a gap, however thin";
}

TEST(Predicates, SharedCornersAndEdgesDoNotCountMoreDoes) {
  const std::vector<Vec3> p{{0, 0, 0},     {1, 0, 0},  {0, 1, 0},     {-1, 0, 0}, {0.2, 0.2, 0},
                            {0.2, 0.2, 1}, {0, -1, 0}, {0.5, 0.5, 0}, {1, 1, -1}, {1, 1, 1}};
  const Triangle t{0, 1, 2};
  EXPECT_FALSE(triangles_intersect(p, t, {0, 3, 6})) << "one corner";
  EXPECT_FALSE(triangles_intersect(p, t, {0, 2, 3})) << "one edge, flat";
  EXPECT_FALSE(triangles_intersect(p, t, {0, 1, 5})) << "one edge, bent";
  EXPECT_TRUE(triangles_intersect(p, t, {0, 1, 4})) << "folded onto it";
  EXPECT_TRUE(triangles_intersect(p, t, {0, 4, 5})) << "one corner, touching inside";
  EXPECT_TRUE(triangles_intersect(p, t, {0, 8, 9})) << "one corner, crossing";
  EXPECT_TRUE(triangles_intersect(p, t, {0, 7, 9})) << "one corner, reaching the far edge";
  EXPECT_TRUE(triangles_intersect(p, t, {1, 2, 0})) << "the same triangle";
}

TEST(Predicates, ParityOnRaysThroughCornersAndEdges) {
  const SurfaceMesh box = test::box_surface({-1, -1, -1}, {1, 1, 1});
  EXPECT_TRUE(is_inside_by_parity(box.points, box.triangles, {0, 0, 0})) << "through a diagonal";
  EXPECT_FALSE(is_inside_by_parity(box.points, box.triangles, {-2, 0, 0}));
  EXPECT_FALSE(is_inside_by_parity(box.points, box.triangles, {-2, -1, -1})) << "along an edge";
  EXPECT_FALSE(is_inside_by_parity(box.points, box.triangles, {-2, 1, 1}));
  EXPECT_FALSE(is_inside_by_parity(box.points, box.triangles, {2, 0, 0}));
  const SurfaceMesh sphere = test::sphere_surface({0, 0, 0}, 1, 2);
  for (const Vec3& point : sphere.points) {
    EXPECT_TRUE(
        is_inside_by_parity(sphere.points, sphere.triangles, {-0.5 * point.x, point.y * 0.5, point.z * 0.5}));
    EXPECT_FALSE(is_inside_by_parity(sphere.points, sphere.triangles, {-3, point.y, point.z}));
  }
}

}  // namespace
}  // namespace periost
