#include <gtest/gtest.h>

#include "pipeline/base/random.h"
#include "pipeline/geometry/predicates.h"
#include "pipeline/geometry/self_intersection.h"
#include "tests/support/surfaces.h"

namespace periost {
namespace {

using Pairs = std::vector<std::pair<Index, Index>>;

Pairs brute_force(const SurfaceMesh& surface) {
  Pairs pairs;
  for (Index i = 0; i < surface.triangles.size(); ++i) {
    for (Index j = i + 1; j < surface.triangles.size(); ++j) {
      if (triangles_intersect(surface.points, surface.triangles[i], surface.triangles[j])) {
        pairs.emplace_back(i, j);
      }
    }
  }
  return pairs;
}

TEST(SelfIntersection, NoneOnASphereOrNestedOnes) {
  const Context context;
  EXPECT_TRUE(self_intersections(test::sphere_surface({100, -50, 3}, 10, 4), context).empty());
  const SurfaceMesh nested =
      test::joined(test::sphere_surface({0, 0, 0}, 2, 3), test::sphere_surface({0, 0, 0}, 1.99, 3));
  EXPECT_TRUE(self_intersections(nested, context).empty());
  EXPECT_TRUE(self_intersections({}, context).empty());
}

TEST(SelfIntersection, CrossingSpheresAsByBruteForce) {
  const SurfaceMesh surface =
      test::joined(test::sphere_surface({0, 0, 0}, 10, 3), test::sphere_surface({7, 1, 2}, 6, 2));
  const Pairs expected = brute_force(surface);
  ASSERT_GT(expected.size(), 20U);
  Context context;
  EXPECT_EQ(self_intersections(surface, context), expected);
  context.threads = 3;
  EXPECT_EQ(self_intersections(surface, context), expected);
  const Pairs few = self_intersections(surface, context, 5);
  EXPECT_EQ(few, Pairs(expected.begin(), expected.begin() + 5));
}

TEST(SelfIntersection, TriangleSoupOnAGridAsByBruteForce) {
  // Corners on a coarse grid: most pairs touch, share corners or lie in one plane; some are degenerate.
  Random random(11, 0);
  SurfaceMesh surface;
  for (int i = 0; i < 60; ++i) {
    surface.points.push_back({0.1 * random.below(5), 0.1 * random.below(5), 0.1 * random.below(4)});
  }
  while (surface.triangles.size() < 400) {
    const Triangle t{random.below(60), random.below(60), random.below(60)};
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) surface.triangles.push_back(t);
  }
  const Pairs expected = brute_force(surface);
  ASSERT_GT(expected.size(), 1000U);
  Context context;
  context.threads = 2;
  EXPECT_EQ(self_intersections(surface, context), expected);
}

TEST(SelfIntersection, TouchingAtAVertexCounts) {
  const SurfaceMesh low = test::box_surface({0, 0, 0}, {1, 1, 1});
  EXPECT_FALSE(
      self_intersections(test::joined(low, test::box_surface({1, 1, 1}, {2, 2, 2})), Context()).empty());
  EXPECT_FALSE(
      self_intersections(test::joined(low, test::box_surface({1, 0, 0}, {2, 1, 1})), Context()).empty())
      << "two faces in one plane";
  EXPECT_FALSE(self_intersections(test::joined(low, low), Context()).empty()) << "the same surface twice";
}

TEST(SelfIntersection, AGapOfOneRoundingStepDoesNot) {
  const SurfaceMesh low = test::box_surface({0, 0, 0}, {1, 1, 1});
  const double next = std::nextafter(1.0, 2.0);
  EXPECT_TRUE(
      self_intersections(test::joined(low, test::box_surface({next, 0, 0}, {2, 1, 1})), Context()).empty());
}

TEST(SelfIntersection, AFlapFoldedOntoItsNeighbour) {
  SurfaceMesh surface;
  surface.points = {{0, 0, 0}, {1, 0, 0}, {0.5, 1, 0}, {0.5, 0.5, 0}};
  surface.triangles = {{0, 1, 2}, {1, 0, 3}};
  EXPECT_EQ(self_intersections(surface, Context()), (Pairs{{0, 1}}));
  surface.points[3].z = 0x1.0p-200;
  EXPECT_TRUE(self_intersections(surface, Context()).empty());
}

}  // namespace
}  // namespace periost
