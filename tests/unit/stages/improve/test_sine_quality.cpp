#include <gtest/gtest.h>

#include <cmath>

#include "pipeline/geometry/tet_quality.h"
#include "stages/improve/sine_quality.h"
#include "tests/unit/stages/improve/improve_shapes.h"

namespace periost {
namespace {

using test::jitter;

Vec3 random_point(std::uint64_t seed, std::uint64_t i) {
  return {20 + jitter(seed, 3 * i), jitter(seed, 3 * i + 1), -7 + jitter(seed, 3 * i + 2)};
}

TEST(SineQuality, RegularTetrahedron) {
  EXPECT_NEAR(smallest_sine({1, 1, 1}, {-1, -1, 1}, {-1, 1, -1}, {1, -1, -1}), std::sqrt(8.0) / 3, 1e-14);
  EXPECT_NEAR(smallest_sine({1, 1, 1}, {-1, 1, -1}, {-1, -1, 1}, {1, -1, -1}), -std::sqrt(8.0) / 3, 1e-14);
  EXPECT_EQ(smallest_sine({0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}), 0);
  // A needle, whose angles are all between 60 and 90 degrees.
  EXPECT_LT(smallest_sine({0, 0, 0}, {1, 0, 0}, {0.5, 0.87, 0}, {0.5, 0.3, 50}), 0.1);
}

TEST(SineQuality, IsThatOfTheAnglesBetweenFaces) {
  for (std::uint64_t i = 0; i < 200; ++i) {
    TetCorners t{random_point(1, 4 * i), random_point(1, 4 * i + 1), random_point(1, 4 * i + 2),
                 random_point(1, 4 * i + 3)};
    if (tet_volume(t) < 0) std::swap(t[0], t[1]);
    const DihedralRange range = tet_dihedral_range(t);
    const double degree = std::acos(-1.0) / 180;
    double squares = 0;
    for (const auto& [i0, i1] : kTetEdge) {
      squares += squared_norm(t[static_cast<std::size_t>(i0)] - t[static_cast<std::size_t>(i1)]);
    }
    const double compact = 6 * std::sqrt(2) * tet_volume(t) / std::pow(squares / 6, 1.5);
    const double expected = std::min({std::sin(range.min_deg * degree), std::sin(range.max_deg * degree),
                                      kCompact * compact, kJacobian * tet_scaled_jacobian(t)});
    EXPECT_NEAR(smallest_sine(t[0], t[1], t[2], t[3]), expected, 1e-11);
  }
}

TEST(SineQuality, GradientsAreFiniteDifferences) {
  constexpr double kStep = 1e-6;
  for (std::uint64_t i = 0; i < 50; ++i) {
    const TetFan fan(random_point(2, 4 * i), random_point(2, 4 * i + 1), random_point(2, 4 * i + 2));
    const Vec3 p = random_point(2, 4 * i + 3);
    SineGradient here[8];
    sines_with_gradients(fan, p, here);
    double least = 2;
    for (const SineGradient& one : here) least = std::min(least, one.sine);
    if (dot(p - fan.a, fan.normal) > 0) {
      EXPECT_NEAR(least, smallest_sine(fan, p), 1e-12);
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      Vec3 up = p, down = p;
      up[axis] += kStep;
      down[axis] -= kStep;
      SineGradient above[8], below[8];
      sines_with_gradients(fan, up, above);
      sines_with_gradients(fan, down, below);
      for (std::size_t k = 0; k < 8; ++k) {
        const double expected = (above[k].sine - below[k].sine) / (2 * kStep);
        EXPECT_NEAR(here[k].gradient[axis], expected, 1e-4 * (1 + norm(here[k].gradient)));
      }
    }
  }
}

TEST(SineQuality, NearestPointOfAHullIsOptimal) {
  for (std::uint64_t i = 0; i < 200; ++i) {
    std::vector<Vec3> points;
    for (std::uint64_t k = 0; k < 2 + i % 9; ++k) {
      const std::uint64_t n = 30 * i + 3 * k;
      points.push_back({jitter(3, n) + 0.01 * static_cast<double>(i), jitter(3, n + 1), jitter(3, n + 2)});
    }
    const Vec3 nearest = nearest_to_origin(points);
    for (const Vec3& point : points) {
      EXPECT_GE(dot(point, nearest), squared_norm(nearest) - 1e-5) << "every point grows along it";
    }
  }
  const std::vector<Vec3> around{{1, 1, 1}, {-1, -1, 1}, {-1, 1, -1}, {1, -1, -1}};
  EXPECT_LT(norm(nearest_to_origin(around)), 1e-12);
}

TEST(SineQuality, ClimbingNeverLoses) {
  const TetMesh mesh = test::bricks(2, 0.4, 5);
  std::vector<TetFan> fans;
  const Index middle = 13;
  for (const Tetrahedron& tet : mesh.tets) {
    for (int k = 0; k < 4; ++k) {
      if (tet[static_cast<std::size_t>(k)] != middle) continue;
      const auto [a, b, c] = face_of(tet, k);
      fans.emplace_back(mesh.points[a], mesh.points[c], mesh.points[b]);
    }
  }
  const double before = smallest_sine(fans, mesh.points[middle]);
  double sine = before;
  const Vec3 place = climb(fans, mesh.points[middle], 1, sine);
  EXPECT_GT(sine, before + 0.05);
  EXPECT_DOUBLE_EQ(sine, smallest_sine(fans, place));
  const Vec3 normal = normalized({1, 2, 3});
  double in_plane = before;
  const Vec3 beside = climb(fans, mesh.points[middle], 1, in_plane, normal);
  EXPECT_GE(in_plane, before);
  EXPECT_NEAR(dot(beside - mesh.points[middle], normal), 0, 1e-12);
}

}  // namespace
}  // namespace periost
