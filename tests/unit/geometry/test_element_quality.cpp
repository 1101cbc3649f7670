#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "pipeline/base/random.h"
#include "pipeline/geometry/tet_quality.h"
#include "pipeline/geometry/triangle_quality.h"
#include "tests/support/rigid_motion.h"

namespace periost {
namespace {

using test::moved;

const TetCorners kRegular{Vec3{1, 1, 1}, Vec3{-1, 1, -1}, Vec3{1, -1, -1}, Vec3{-1, -1, 1}};
const TetCorners kCorner{Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};

Vec3 random_point(Random& random) {
  return {random.uniform(), random.uniform(), random.uniform()};
}

TetCorners random_tet(Random& random) {
  TetCorners t;
  do {
    for (Vec3& p : t) p = random_point(random);
    if (tet_volume(t) < 0) std::swap(t[0], t[1]);
  } while (tet_volume(t) < 1e-3);
  return t;
}

Tet10Nodes straight(const TetCorners& t) {
  return {t[0],
          t[1],
          t[2],
          t[3],
          0.5 * (t[0] + t[1]),
          0.5 * (t[1] + t[2]),
          0.5 * (t[2] + t[0]),
          0.5 * (t[0] + t[3]),
          0.5 * (t[1] + t[3]),
          0.5 * (t[2] + t[3])};
}

TEST(TriangleQuality, KnownTriangles) {
  const Vec3 a{0, 0, 0}, b{1, 0, 0}, c{0.5, std::sqrt(3.0) / 2, 0};
  EXPECT_NEAR(triangle_min_angle_deg(a, b, c), 60, 1e-12);
  EXPECT_NEAR(triangle_radius_ratio(a, b, c), 1, 1e-12);
  EXPECT_NEAR(triangle_min_angle_deg({0, 0, 0}, {3, 0, 0}, {0, 4, 0}),
              std::atan2(3, 4) * 180 / std::numbers::pi, 1e-12);
  // 3-4-5: R = 2.5, r = 1.
  EXPECT_NEAR(triangle_radius_ratio({0, 0, 0}, {3, 0, 0}, {0, 4, 0}), 1.25, 1e-12);
}

TEST(TriangleQuality, ThinTrianglesGoToTheEndsOfTheRange) {
  for (const double h : {1e-2, 1e-4, 1e-6}) {
    // A needle with apex angle 2 atan(h / 2), and a cap with base angles atan(2 h).
    EXPECT_NEAR(triangle_min_angle_deg({0, 0, 0}, {h, 0, 0}, {h / 2, 1, 0}),
                2 * std::atan(h / 2) * 180 / std::numbers::pi, 1e-10);
    EXPECT_NEAR(triangle_min_angle_deg({0, 0, 0}, {1, 0, 0}, {0.5, h, 0}),
                std::atan(2 * h) * 180 / std::numbers::pi, 1e-10);
  }
  const Vec3 a{1, 2, 3}, b{2, 3, 4}, middle{1.5, 2.5, 3.5};
  EXPECT_EQ(triangle_min_angle_deg(a, b, middle), 0);
  EXPECT_EQ(triangle_min_angle_deg(a, a, b), 0);
  EXPECT_EQ(triangle_radius_ratio(a, b, middle), kUnboundedMetric);
  EXPECT_EQ(triangle_radius_ratio(a, a, a), kUnboundedMetric);
}

TEST(TriangleQuality, InvariantUnderMotionScaleAndRenumbering) {
  Random random(1, 0);
  for (int i = 0; i < 200; ++i) {
    const Vec3 a = random_point(random), b = random_point(random), c = random_point(random);
    const double angle = triangle_min_angle_deg(a, b, c), ratio = triangle_radius_ratio(a, b, c);
    EXPECT_GE(ratio, 1 - 1e-12);
    EXPECT_LE(angle, 60);
    EXPECT_NEAR(triangle_min_angle_deg(moved(a), moved(b), moved(c)), angle, 1e-8);
    EXPECT_NEAR(triangle_min_angle_deg(c, a, b), angle, 1e-12);
    EXPECT_NEAR(triangle_min_angle_deg(b, a, c), angle, 1e-12);
    EXPECT_NEAR(triangle_radius_ratio(moved(b), moved(a), moved(c)) / ratio, 1, 1e-8);
  }
}

TEST(TetQuality, TheRegularTetrahedronIsIdeal) {
  EXPECT_GT(tet_volume(kRegular), 0);
  const double dihedral = std::acos(1.0 / 3) * 180 / std::numbers::pi;
  EXPECT_NEAR(tet_dihedral_range(kRegular).min_deg, dihedral, 1e-12);
  EXPECT_NEAR(tet_dihedral_range(kRegular).max_deg, dihedral, 1e-12);
  EXPECT_NEAR(tet_radius_ratio(kRegular), 1, 1e-12);
  EXPECT_NEAR(tet_scaled_jacobian(kRegular), 1, 1e-12);
  EXPECT_NEAR(tet_mean_ratio(kRegular), 1, 1e-12);
  EXPECT_NEAR(tet_aspect_ratio(kRegular), 1, 1e-12);
  EXPECT_NEAR(tet10_jacobian_ratio(straight(kRegular)), 1, 1e-12);
}

TEST(TetQuality, TheCornerOfACube) {
  EXPECT_NEAR(tet_volume(kCorner), 1.0 / 6, 1e-15);
  EXPECT_NEAR(tet_dihedral_range(kCorner).min_deg, std::acos(1 / std::sqrt(3.0)) * 180 / std::numbers::pi,
              1e-12);
  EXPECT_NEAR(tet_dihedral_range(kCorner).max_deg, 90, 1e-12);
  // R = sqrt(3)/2, r = 1/(3 + sqrt(3)).
  EXPECT_NEAR(tet_radius_ratio(kCorner), std::sqrt(3.0) / 2 * (3 + std::sqrt(3.0)) / 3, 1e-12);
  // Largest product of edges: at a corner on an axis, 1 * sqrt(2) * sqrt(2).
  EXPECT_NEAR(tet_scaled_jacobian(kCorner), std::sqrt(2.0) / 2, 1e-12);
  EXPECT_NEAR(tet_mean_ratio(kCorner), 12 * std::cbrt(0.25) / 9, 1e-12);
  EXPECT_NEAR(tet_aspect_ratio(kCorner), std::sqrt(2.0) * (3 + std::sqrt(3.0)) / (2 * std::sqrt(6.0)), 1e-12);
}

TEST(TetQuality, ASliverOfHeightHHasTheAnglesOfItsClosedForm) {
  for (const double h : {0.1, 1e-3, 1e-5}) {
    // Two crossing edges of length 2 at heights 0 and h. The faces on such an edge rise from it by h over 1
    // on either side; the faces on the other four edges have normals (h, h, +-1) up to signs.
    const TetCorners sliver{Vec3{-1, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, h}, Vec3{0, -1, h}};
    ASSERT_GT(tet_volume(sliver), 0);
    const DihedralRange range = tet_dihedral_range(sliver);
    const double degree = std::numbers::pi / 180;
    EXPECT_NEAR(range.max_deg, 180 - 2 * std::atan(h) / degree, 1e-9);
    EXPECT_NEAR(range.min_deg, std::acos(1 / (1 + h * h)) / degree, 1e-5);
    EXPECT_NEAR(tet_volume(sliver), 4 * h / 6, 1e-15);
    EXPECT_NEAR(tet_mean_ratio(sliver), 12 * std::cbrt(4 * h * h) / (8 + 4 * (2 + h * h)), 1e-12);
  }
}

TEST(TetQuality, InvertedAndFlatTetrahedraGetTheWorstValues) {
  const TetCorners inverted{kRegular[1], kRegular[0], kRegular[2], kRegular[3]};
  EXPECT_NEAR(tet_scaled_jacobian(inverted), -1, 1e-12);
  const TetCorners flat{Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{1, 1, 0}, Vec3{0, 1, 0}};
  for (const TetCorners& t : {inverted, flat}) {
    EXPECT_EQ(tet_radius_ratio(t), kUnboundedMetric);
    EXPECT_EQ(tet_aspect_ratio(t), kUnboundedMetric);
    EXPECT_EQ(tet_mean_ratio(t), 0);
    EXPECT_LE(tet_scaled_jacobian(t), 0);
  }
  EXPECT_NEAR(tet_dihedral_range(flat).min_deg, 0, 1e-12);
  EXPECT_NEAR(tet_dihedral_range(flat).max_deg, 180, 1e-12);
  const TetCorners point{};
  EXPECT_EQ(tet_dihedral_range(point).min_deg, 0);
  EXPECT_EQ(tet_dihedral_range(point).max_deg, 180);
  EXPECT_EQ(tet_scaled_jacobian(point), 0);
}

TEST(TetQuality, SizeRatio) {
  EXPECT_NEAR(tet_size_ratio(8, 1), 2, 1e-15);
  EXPECT_NEAR(tet_size_ratio(1, -27), 3, 1e-14);
  EXPECT_EQ(tet_size_ratio(0, 1), kUnboundedMetric);
}

TEST(TetQuality, InvariantUnderMotionScaleAndEvenRenumbering) {
  const std::function<double(const TetCorners&)> metrics[] = {
      [](const TetCorners& t) { return tet_dihedral_range(t).min_deg; },
      [](const TetCorners& t) { return tet_dihedral_range(t).max_deg; },
      tet_radius_ratio,
      tet_scaled_jacobian,
      tet_mean_ratio,
      tet_aspect_ratio,
      [](const TetCorners& t) { return tet10_jacobian_ratio(straight(t)); }};
  Random random(2, 0);
  for (int i = 0; i < 200; ++i) {
    const TetCorners t = random_tet(random);
    const TetCorners other{moved(t[1]), moved(t[2]), moved(t[0]), moved(t[3])};
    const TetCorners turned{t[3], t[0], t[2], t[1]};
    ASSERT_GT(tet_volume(turned), 0);
    for (const auto& metric : metrics) {
      EXPECT_NEAR(metric(other) / metric(t), 1, 1e-8);
      EXPECT_NEAR(metric(turned) / metric(t), 1, 1e-10);
    }
  }
}

TEST(Tet10Quality, AMovedMidsideNodeLowersTheRatioUntilItFolds) {
  Tet10Nodes nodes = straight(kCorner);
  // With the node of edge 01 at (0.5 + s, 0, 0), dx/dl1 along the edge at corner 0 is 1 + 4 s, at corner 1
  // 1 - 4 s: the ratio of the extreme corner determinants.
  for (const double s : {0.05, 0.1, 0.2}) {
    nodes[4] = {0.5 + s, 0, 0};
    EXPECT_NEAR(tet10_min_corner_jacobian(nodes), 1 - 4 * s, 1e-12);
    EXPECT_NEAR(tet10_jacobian_ratio(nodes), (1 - 4 * s) / (1 + 4 * s), 1e-12);
  }
  nodes[4] = {0.8, 0, 0};
  EXPECT_LT(tet10_jacobian_ratio(nodes), 0);
  EXPECT_LT(tet10_min_corner_jacobian(nodes), 0);
}

TEST(Tet10Quality, StraightElementsHaveRatioOneAndSixVolumes) {
  Random random(3, 0);
  for (int i = 0; i < 50; ++i) {
    const TetCorners t = random_tet(random);
    EXPECT_NEAR(tet10_jacobian_ratio(straight(t)), 1, 1e-10);
    EXPECT_NEAR(tet10_min_corner_jacobian(straight(t)), 6 * tet_volume(t), 1e-12);
  }
}

}  // namespace
}  // namespace periost
