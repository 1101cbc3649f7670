#include <gtest/gtest.h>

#include <numbers>

#include "pipeline/base/random.h"
#include "pipeline/geometry/simplex_dual.h"
#include "pipeline/geometry/simplex_geometry.h"
#include "pipeline/geometry/simplex_operators.h"
#include "tests/support/surfaces.h"

namespace periost {
namespace {

constexpr double kPi = std::numbers::pi;

Vec3 random_point(Random& random) {
  return {4 * random.uniform() - 2, 4 * random.uniform() - 2, 4 * random.uniform() - 2};
}

TEST(SimplexGeometry, MetricParametersRebuildTheVertex) {
  Random random(1, 0);
  for (int i = 0; i < 1000; ++i) {
    const std::array<Vec3, 3> around{random_point(random), random_point(random), random_point(random)};
    const Vec3 p = random_point(random);
    const SimplexParameters s = simplex_parameters(p, around);
    const auto& e = s.barycentric;
    EXPECT_NEAR(e[0] + e[1] + e[2], 1, 1e-9);
    EXPECT_NEAR(distance(e[0] * around[0] + e[1] * around[1] + e[2] * around[2] + s.height * s.normal, p), 0,
                1e-7);
    EXPECT_NEAR(norm(s.normal), 1, 1e-12);
  }
}

TEST(SimplexGeometry, PowerAndRadiusMatchTheCircumcircle) {
  Random random(2, 0);
  for (int i = 0; i < 1000; ++i) {
    // Neighbours on a known circle, so centre and radius are given.
    const double r = 0.5 + random.uniform(), t = 2 * kPi * random.uniform();
    std::array<Vec3, 3> around;
    for (std::size_t k = 0; k < 3; ++k) {
      const double angle = t + 2.0 * static_cast<double>(k) + random.uniform();
      around[k] = {3 + r * std::cos(angle), -2 + r * std::sin(angle), 7};
    }
    const Vec3 p{3 + 3 * random.uniform() - 1.5, -2 + 3 * random.uniform() - 1.5, 7.3};
    const SimplexParameters s = simplex_parameters(p, around);
    const double d2 = (p.x - 3) * (p.x - 3) + (p.y + 2) * (p.y + 2);
    EXPECT_NEAR(s.circumradius, r, 1e-9);
    EXPECT_NEAR(s.power, r * r - d2, 1e-7);
    EXPECT_NEAR(s.height, 0.3, 1e-9);
  }
}

TEST(SimplexGeometry, HeightAtAngleInvertsTheAngle) {
  Random random(3, 0);
  int inside = 0, outside = 0;
  for (int i = 0; i < 20000; ++i) {
    const std::array<Vec3, 3> around{random_point(random), random_point(random), random_point(random)};
    const SimplexParameters s = simplex_parameters(random_point(random), around);
    if (s.circumradius > 20) continue;
    if (s.power < 0 && s.height * s.height > 0.99 * -s.power) continue;
    if (std::abs(s.power) < 1e-3) continue;
    (s.power < 0 ? outside : inside) += 1;
    const double back = height_at_angle(simplex_angle(s), s.power, s.circumradius);
    ASSERT_NEAR(back, s.height, 1e-8 * (1 + std::abs(s.height)))
        << "power " << s.power << ", r " << s.circumradius;
  }
  EXPECT_GT(inside, 1000);
  EXPECT_GT(outside, 1000);
}

TEST(SimplexGeometry, PlanarNeighbourhoodsHaveAngleZero) {
  const std::array<Vec3, 3> around{Vec3{0, 0, 0}, Vec3{2, 0, 0}, Vec3{0, 1, 0}};
  for (const Vec3 p : {Vec3{0.5, 0.3, 0}, Vec3{3, 4, 0}, Vec3{-5, 0.1, 0}}) {
    const SimplexParameters s = simplex_parameters(p, around);
    EXPECT_EQ(simplex_angle(s), 0);
    EXPECT_EQ(height_at_angle(0, s.power, s.circumradius), 0);
  }
}

TEST(SimplexGeometry, OnASphereTheSineIsCircumradiusOverRadius) {
  Random random(4, 0);
  const double radius = 3;
  const Vec3 centre{10, -4, 2};
  for (int i = 0; i < 1000; ++i) {
    const auto on_sphere = [&] { return centre + radius * normalized(random_point(random)); };
    const SimplexParameters s = simplex_parameters(on_sphere(), {on_sphere(), on_sphere(), on_sphere()});
    if (s.is_degenerate || s.power < 0) continue;
    EXPECT_NEAR(std::abs(std::sin(simplex_angle(s))), s.circumradius / radius, 1e-8);
  }
}

TEST(SimplexGeometry, TheAngleIsPositiveWhereASurfaceIsConvex) {
  const SimplexMesh mesh = dual_simplex_mesh(test::sphere_surface({1, 2, 3}, 5, 2));
  for (std::uint32_t v = 0; v < mesh.face.size(); ++v) {
    EXPECT_GT(simplex_angle(simplex_parameters(mesh, SimplexVertex{v})), 0);
  }
}

TEST(SimplexGeometry, InvariantUnderRigidMotionAndScale) {
  Random random(5, 0);
  const double a = 0.7, b = -1.1, scale = 3.7;
  const auto moved = [&](Vec3 p) {
    const Vec3 q{std::cos(a) * p.x - std::sin(a) * p.y, std::sin(a) * p.x + std::cos(a) * p.y, p.z};
    const Vec3 r{q.x, std::cos(b) * q.y - std::sin(b) * q.z, std::sin(b) * q.y + std::cos(b) * q.z};
    return scale * r + Vec3{100, -50, 25};
  };
  for (int i = 0; i < 1000; ++i) {
    const std::array<Vec3, 3> around{random_point(random), random_point(random), random_point(random)};
    const Vec3 p = random_point(random);
    const SimplexParameters s = simplex_parameters(p, around);
    if (s.circumradius > 20) continue;
    const SimplexParameters t =
        simplex_parameters(moved(p), {moved(around[0]), moved(around[1]), moved(around[2])});
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(t.barycentric[k], s.barycentric[k], 1e-6);
    EXPECT_NEAR(t.height, scale * s.height, 1e-7);
    EXPECT_NEAR(std::cos(simplex_angle(t)), std::cos(simplex_angle(s)), 1e-6);
    EXPECT_NEAR(std::sin(simplex_angle(t)), std::sin(simplex_angle(s)), 1e-6);
  }
}

TEST(SimplexGeometry, DegenerateNeighboursAreSaidToBe) {
  EXPECT_TRUE(simplex_parameters({1, 1, 1}, {Vec3{0, 0, 0}, Vec3{1, 1, 0}, Vec3{2, 2, 0}}).is_degenerate);
  EXPECT_TRUE(simplex_parameters({1, 1, 1}, {Vec3{}, Vec3{}, Vec3{}}).is_degenerate);
}

}  // namespace
}  // namespace periost
