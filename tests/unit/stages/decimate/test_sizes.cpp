// Limits on the sizes of triangles: longest edges everywhere, near places and in thin parts, and grading.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "pipeline/geometry/simplex_dual.h"
#include "pipeline/geometry/topology.h"
#include "stages/decimate/certified.h"
#include "tests/unit/stages/decimate/phantoms.h"

namespace periost {
namespace {

constexpr Vec3 kSpacing{0.7, 0.7, 1.1};

SurfaceMesh decimated_by(const Isosurface& isosurface, const DecimateOptions& options) {
  Context context;
  const SurfaceMesh surface = dual_triangulation(decimate_certified(isosurface, options, context));
  const Topology topology = examine_topology(surface);
  EXPECT_TRUE(topology.is_closed() && topology.is_manifold());
  return surface;
}

DecimateOptions coarse() {
  DecimateOptions options;
  options.distance = Length::voxel(1);
  return options;
}

double longest_edge_of(const SurfaceMesh& surface, const Triangle& t) {
  const Vec3 a = surface.points[t[0]], b = surface.points[t[1]], c = surface.points[t[2]];
  return std::max({distance(a, b), distance(b, c), distance(c, a)});
}

Vec3 centroid_of(const SurfaceMesh& surface, const Triangle& t) {
  return (surface.points[t[0]] + surface.points[t[1]] + surface.points[t[2]]) / 3;
}

double longest_edge_of(const SurfaceMesh& surface) {
  double longest = 0;
  for (const Triangle& t : surface.triangles) longest = std::max(longest, longest_edge_of(surface, t));
  return longest;
}

TEST(Sizes, NoEdgeIsLongerThanAsked) {
  const Isosurface ball = test::binary_ball(9, kSpacing);
  EXPECT_GT(longest_edge_of(decimated_by(ball, coarse())), 3.5);
  DecimateOptions options = coarse();
  options.max_edge = Length::mm(2.5);
  const SurfaceMesh limited = decimated_by(ball, options);
  EXPECT_LE(longest_edge_of(limited), 2.5 + 1e-9);
  EXPECT_LT(limited.triangles.size(), ball.surface.triangles.size() / 2);
  options.max_edge = Length::voxel(2.5 / 1.1);
  EXPECT_EQ(decimated_by(ball, options).points, limited.points) << "voxels are of the largest side";
}

TEST(Sizes, EdgesAreShorterAroundAPlace) {
  const Isosurface ball = test::binary_ball(9, kSpacing);
  DecimateOptions options = coarse();
  const Vec3 place = ball.surface.points[0];
  options.refine = {{place, 4, Length::mm(1.6)}};
  const SurfaceMesh surface = decimated_by(ball, options);
  double inside = 0, outside = 0;
  for (const Triangle& t : surface.triangles) {
    const double away = distance(centroid_of(surface, t), place);
    double& longest = away < 2 ? inside : outside;
    if (away < 2 || away > 7) longest = std::max(longest, longest_edge_of(surface, t));
  }
  EXPECT_GT(inside, 0);
  EXPECT_LE(inside, 1.6 + 1e-9);
  EXPECT_GT(outside, 2.5);
}

// A plate four voxels thick with a ball at its rim: the plate alone is thin.
TEST(Sizes, ThinWallsHaveShortEdges) {
  const Isosurface shape = test::binary_shape(40, {1, 1, 1}, [](Vec3 p) {
    return norm(p - Vec3{-9, 0, 0}) <= 8 ||
           (std::abs(p.z) <= 1.5 && p.x > -9 && p.x < 16 && std::abs(p.y) < 12);
  });
  DecimateOptions options = coarse();
  const std::size_t free = decimated_by(shape, options).triangles.size();
  options.edge_per_thickness = 1;
  const SurfaceMesh surface = decimated_by(shape, options);
  EXPECT_GT(surface.triangles.size(), free);
  // The middle of the plate, off the ball: the wall is 4 mm thick there.
  const Vec3 middle = shape.frame.to_lps({19.5, 19.5, 19.5});
  double longest = 0;
  for (const Triangle& t : surface.triangles) {
    const Vec3 q = centroid_of(surface, t) - middle;
    if (q.x > 3 && q.x < 12 && std::abs(q.y) < 8) longest = std::max(longest, longest_edge_of(surface, t));
  }
  EXPECT_GT(longest, 1);
  EXPECT_LE(longest, 4 + 1e-6);
}

// Sums of excesses must not grow, so what marching cubes leaves may stay; but most of it must have gone.
TEST(Sizes, GradingEvensNeighbours) {
  const Isosurface torus = test::binary_torus(12, 5);
  const auto share_over = [](const SurfaceMesh& surface, double ratio) {
    std::map<std::pair<Index, Index>, double> first;
    std::size_t over = 0, edges = 0;
    for (const Triangle& t : surface.triangles) {
      const double size = longest_edge_of(surface, t);
      for (std::size_t k = 0; k < 3; ++k) {
        const auto [found, is_new] = first.try_emplace(std::minmax(t[k], t[(k + 1) % 3]), size);
        if (is_new) continue;
        ++edges;
        over += std::max(size, found->second) / std::min(size, found->second) > ratio;
      }
    }
    return static_cast<double>(over) / static_cast<double>(edges);
  };
  DecimateOptions options = coarse();
  const double free = share_over(decimated_by(torus, options), 1.3);
  options.grading = 1.3;
  const double graded = share_over(decimated_by(torus, options), 1.3);
  EXPECT_GT(free, 0.05);
  EXPECT_LT(graded, 0.5 * free);
}

}  // namespace
}  // namespace periost
