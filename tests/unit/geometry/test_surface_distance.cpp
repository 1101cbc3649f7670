#include "pipeline/geometry/surface_distance.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <numbers>

#include "pipeline/base/random.h"
#include "pipeline/geometry/distribution.h"
#include "pipeline/geometry/extremes.h"
#include "tests/support/rigid_motion.h"
#include "tests/support/surfaces.h"

namespace periost {
namespace {

using test::box_surface;
using test::moved;
using test::sphere_surface;
using test::torus_surface;

// The nearest of a grid of points of the triangle, by brute force.
double sampled_distance(Vec3 p, Vec3 a, Vec3 b, Vec3 c) {
  double best = std::numeric_limits<double>::infinity();
  const int n = 200;
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; i + j <= n; ++j) {
      best = std::min(best, distance(p, a + (b - a) * (double(i) / n) + (c - a) * (double(j) / n)));
    }
  }
  return best;
}

TEST(ClosestPoint, OnATriangleAgreesWithBruteForce) {
  Random random(5, 0);
  const auto point = [&] { return Vec3{random.uniform(), random.uniform(), random.uniform()}; };
  for (int i = 0; i < 200; ++i) {
    const Vec3 a = point(), b = point(), c = point(), p = 2.0 * point() - Vec3{0.5, 0.5, 0.5};
    const double exact = distance(p, closest_point_on_triangle(p, a, b, c));
    const double sampled = sampled_distance(p, a, b, c);
    EXPECT_LE(exact, sampled + 1e-12);
    EXPECT_NEAR(exact, sampled, 0.02);
  }
  // A triangle without area is a segment, or a point.
  EXPECT_EQ(closest_point_on_triangle({0, 1, 0}, {-1, 0, 0}, {1, 0, 0}, {0, 0, 0}), (Vec3{0, 0, 0}));
  EXPECT_EQ(closest_point_on_triangle({3, 1, 0}, {1, 0, 0}, {1, 0, 0}, {1, 0, 0}), (Vec3{1, 0, 0}));
  // Two corners in one place, whichever.
  EXPECT_EQ(closest_point_on_triangle({2, 1, 0}, {1, 0, 0}, {1, 0, 0}, {5, 0, 0}), (Vec3{2, 0, 0}));
  EXPECT_EQ(closest_point_on_triangle({2, 1, 0}, {1, 0, 0}, {5, 0, 0}, {1, 0, 0}), (Vec3{2, 0, 0}));
  EXPECT_EQ(closest_point_on_triangle({2, 1, 0}, {5, 0, 0}, {1, 0, 0}, {1, 0, 0}), (Vec3{2, 0, 0}));
}

TEST(SpatialSearch, AgreesWithTryingEveryTriangle) {
  Context context;
  Random random(6, 0);
  for (const SurfaceMesh& mesh : {box_surface({-1, -2, 100}, {2, 1, 103}), torus_surface(5, 2, 60, 40)}) {
    const SpatialSearch search(mesh, context);
    Index hint = kNoIndex;
    for (int i = 0; i < 300; ++i) {
      const Vec3 near = mesh.points[random.below(static_cast<std::uint32_t>(mesh.points.size()))];
      const Vec3 p = near + Vec3{random.uniform() - 0.5, random.uniform() - 0.5, random.uniform() - 0.5} * 4;
      double best = std::numeric_limits<double>::infinity();
      for (const auto& [a, b, c] : mesh.triangles) {
        best = std::min(best, squared_norm(p - closest_point_on_triangle(p, mesh.points[a], mesh.points[b],
                                                                         mesh.points[c])));
      }
      const auto hit = search.closest(p), hinted = search.closest(p, hint);
      EXPECT_EQ(hit.squared_distance, best);
      EXPECT_EQ(hinted.squared_distance, best);
      EXPECT_EQ(squared_norm(p - hit.point), best);
      const auto& [a, b, c] = mesh.triangles[hit.triangle];
      EXPECT_EQ(closest_point_on_triangle(p, mesh.points[a], mesh.points[b], mesh.points[c]), hit.point);
      hint = hit.slot;
    }
  }
}

TEST(SurfaceDistance, AShiftedBoxIsFarByItsShift) {
  // Along x the sides parallel to the shift stay, the others are 0.25 apart.
  const SurfaceMesh box = box_surface({0, 0, 0}, {1, 2, 3}), other = box_surface({0.25, 0, 0}, {1.25, 2, 3});
  const auto d = two_sided_distance(box, other, {}, Context{});
  EXPECT_NEAR(d.forward.summary.max, 0.25, 1e-12);
  EXPECT_NEAR(d.backward.summary.max, 0.25, 1e-12);
  EXPECT_GT(d.forward.summary.rms, d.forward.summary.mean);
  EXPECT_LE(d.forward.summary.p99, d.forward.summary.max);
  ASSERT_EQ(d.forward.worst.size(), 10u);
  EXPECT_EQ(d.forward.worst[0].value, d.forward.summary.max);
}

TEST(SurfaceDistance, OneSideCanBeZeroWhileTheOtherIsNot) {
  const SurfaceMesh box = box_surface({0, 0, 0}, {1, 1, 1});
  const SurfaceMesh two = test::joined(box, box_surface({5, 0, 0}, {6, 1, 1}));
  const auto d = two_sided_distance(box, two, {}, Context{});
  EXPECT_NEAR(d.forward.summary.max, 0, 1e-15);
  EXPECT_NEAR(d.backward.summary.max, 5, 1e-12);
}

TEST(SurfaceDistance, TheMaximumIsFoundInsideTriangles) {
  // The centre of a large flat square, subdivided nowhere, is farthest from a pyramid's tip above it.
  SurfaceMesh square, pyramid;
  square.points = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  square.triangles = {{0, 1, 2}, {0, 2, 3}};
  pyramid.points = square.points;
  pyramid.points.push_back({0.3, 0.1, 0.5});
  pyramid.triangles = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
  DistanceOptions options;
  options.max_tolerance = 1e-3;
  const double found = distance_to(square, SpatialSearch(pyramid, Context{}), options, Context{}).summary.max;
  double dense = 0;
  const SpatialSearch search(pyramid, Context{});
  const int n = 600;
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; j <= n; ++j) {
      dense = std::max(dense, search.closest({-1 + 2.0 * i / n, -1 + 2.0 * j / n, 0}).squared_distance);
    }
  }
  EXPECT_GE(found * 1.0011, std::sqrt(dense));
  EXPECT_LE(found, std::sqrt(dense) + 2e-3);
}

TEST(SurfaceDistance, SpheresOfTwoRadii) {
  const auto d =
      two_sided_distance(sphere_surface({3, 4, 5}, 10, 4), sphere_surface({3, 4, 5}, 10.5, 4), {}, {});
  EXPECT_NEAR(d.forward.summary.mean, 0.5, 0.01);
  EXPECT_NEAR(d.forward.summary.p99, 0.5, 0.02);
  EXPECT_NEAR(d.backward.summary.max, 0.5, 0.03);
}

// A square plate of n x n x 2 triangles.
SurfaceMesh plate(Index n) {
  SurfaceMesh mesh;
  for (Index j = 0; j <= n; ++j) {
    for (Index i = 0; i <= n; ++i) mesh.points.push_back({10.0 * i / n, 10.0 * j / n, 3});
  }
  for (Index j = 0; j < n; ++j) {
    for (Index i = 0; i < n; ++i) {
      const Index a = j * (n + 1) + i, b = a + n + 1;
      mesh.triangles.insert(mesh.triangles.end(), {{a, a + 1, b}, {a + 1, b + 1, b}});
    }
  }
  return mesh;
}

// Every piece lies across edges of the other plate; cut down until its corners have one triangle in common,
// none would ever be small enough, and this would take minutes.
TEST(SurfaceDistance, OneSurfaceCutTwoWaysIsNowhereAway) {
  const TwoSidedDistance both = two_sided_distance(plate(90), plate(77), {}, Context());
  EXPECT_LE(both.forward.summary.max, 1e-12);
  EXPECT_LE(both.backward.summary.max, 1e-12);
}

TEST(SurfaceDistance, InvariantUnderMotionAndProportionalToScale) {
  SurfaceMesh a = torus_surface(5, 2, 40, 20), b = torus_surface(5, 2, 13, 9);
  const auto before = two_sided_distance(a, b, {}, Context{});
  for (Vec3& p : a.points) p = moved(p);
  for (Vec3& p : b.points) p = moved(p);
  const auto after = two_sided_distance(a, b, {}, Context{});
  EXPECT_NEAR(after.forward.summary.max / before.forward.summary.max, 3.7, 0.02);
  EXPECT_NEAR(after.forward.summary.mean / before.forward.summary.mean, 3.7, 1e-6);
  EXPECT_NEAR(after.backward.summary.rms / before.backward.summary.rms, 3.7, 1e-6);
}

TEST(SurfaceDistance, ThreadsDoNotChangeABit) {
  const SurfaceMesh a = torus_surface(5, 2, 100, 50), b = torus_surface(5, 1.9, 60, 30);
  Context one, three;
  three.threads = 3;
  const auto x = two_sided_distance(a, b, {}, one), y = two_sided_distance(a, b, {}, three);
  EXPECT_EQ(std::memcmp(&x.forward.summary, &y.forward.summary, sizeof(DistanceSummary)), 0);
  EXPECT_EQ(std::memcmp(&x.backward.summary, &y.backward.summary, sizeof(DistanceSummary)), 0);
  for (std::size_t i = 0; i < 10; ++i) {
    EXPECT_EQ(x.forward.worst[i].element, y.forward.worst[i].element);
    EXPECT_EQ(x.forward.worst[i].centre_mm, y.forward.worst[i].centre_mm);
  }
}

TEST(SurfaceDistance, UnitsAndTheRequestedDistance) {
  TwoSidedDistance d;
  d.forward.summary = {0.6, 0.1, 0.2, 0.5};
  d.backward.summary = {0.3, 0.1, 0.2, 0.2};
  const SurfaceDistance voxels = summarise(d, 1.5, 0.5);
  EXPECT_EQ(voxels.unit, "voxel");
  EXPECT_NEAR(voxels.hausdorff, 0.4, 1e-15);
  EXPECT_NEAR(*voxels.requested, 1.0 / 3, 1e-15);
  EXPECT_NEAR(*voxels.over_requested, 0.2, 1e-12);
  const SurfaceDistance plain = summarise(d, 0, std::nullopt);
  EXPECT_EQ(plain.unit, "mm");
  EXPECT_EQ(plain.hausdorff, 0.6);
  EXPECT_FALSE(plain.over_requested.has_value());
  EXPECT_EQ(*summarise(d, 1, 0.7).over_requested, 0);
}

TEST(Distribution, PercentilesInterpolateBetweenOrderStatistics) {
  std::vector<double> values;
  for (int i = 100; i >= 0; --i) values.push_back(i * 0.5);
  const Distribution d = distribution_of(values);
  EXPECT_EQ(d.count, 101u);
  EXPECT_EQ(d.min, 0);
  EXPECT_NEAR(d.p01, 0.5, 1e-12);
  EXPECT_NEAR(d.p05, 2.5, 1e-12);
  EXPECT_NEAR(d.p50, 25, 1e-12);
  EXPECT_NEAR(d.p99, 49.5, 1e-12);
  EXPECT_EQ(d.max, 50);
  EXPECT_NEAR(d.mean, 25, 1e-12);
  const Distribution two = distribution_of({1, 3});
  EXPECT_NEAR(two.p50, 2, 1e-15);
  EXPECT_NEAR(two.p99, 2.98, 1e-12);
  EXPECT_EQ(distribution_of({}).count, 0u);
  EXPECT_EQ(distribution_of({7}).p01, 7);
}

TEST(Extremes, KeepTheTenWorstInOrder) {
  Extremes low(Extremes::Side::kLowest), high(Extremes::Side::kHighest);
  for (std::uint64_t i = 0; i < 100; ++i) {
    const double value = static_cast<double>(i * 37 % 100 / 2);
    low.add(i, value, {});
    high.add(i, value, {});
  }
  const auto lowest = low.take(), highest = high.take();
  ASSERT_EQ(lowest.size(), 10u);
  for (std::size_t k = 0; k < 10; ++k) {
    EXPECT_EQ(lowest[k].value, static_cast<double>(k / 2));
    EXPECT_EQ(highest[k].value, 49 - static_cast<double>(k / 2));
  }
  EXPECT_LT(lowest[0].element, lowest[1].element);
}

}  // namespace
}  // namespace periost
