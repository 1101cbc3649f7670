#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <string>

#include "pipeline/base/error.h"
#include "pipeline/geometry/measure_volume.h"
#include "pipeline/geometry/self_intersection.h"
#include "pipeline/geometry/surface_distance.h"
#include "pipeline/geometry/tet_faces.h"
#include "pipeline/geometry/topology.h"
#include "stages/improve/improve.h"
#include "stages/tetgen/tetgen.h"
#include "tests/support/fit_for_mechanics.h"
#include "tests/support/surfaces.h"
#include "tests/unit/stages/improve/improve_shapes.h"
#include "tests/unit/stages/tetgen/worker_context.h"

namespace periost {
namespace {

using test::bricks;
using test::dihedrals;
using test::whole_volume6;

// An uneven thin shell, whose mesh by TetGen has slivers that no change inside can mend.
SurfaceMesh shell() {
  SurfaceMesh surface = test::joined(test::sphere_surface({40, -20, 10}, 10, 3),
                                     test::inverted(test::sphere_surface({40, -20, 10.2}, 9.2, 3)));
  for (std::size_t i = 0; i < surface.points.size(); ++i) {
    for (std::size_t a = 0; a < 3; ++a) surface.points[i][a] += 0.2 * test::jitter(9, 3 * i + a);
  }
  return surface;
}

ImproveOptions fixed() {
  ImproveOptions options;
  options.boundary = BoundaryMotion::kFixed;
  return options;
}

// What holds for every result.
void expect_sound(const TetMesh& mesh) {
  for (const Tetrahedron& t : mesh.tets) ASSERT_GT(test::volume6(mesh, t), 0);
  EXPECT_EQ(mesh.region.size(), mesh.tets.size());
  TetMesh again = mesh;
  test::add_boundary(again);
  EXPECT_EQ(test::sorted_boundary(again.boundary), test::sorted_boundary(mesh.boundary));
  test::expect_fit_for_mechanics(mesh);
}

TEST(Improve, FixedBoundaryStaysToTheLastBit) {
  const TetMesh mesh = bricks(6, 0.45, 21);
  const ImproveResult result = improve(mesh, {}, fixed(), {});
  expect_sound(result.mesh);
  EXPECT_GT(dihedrals(result.mesh).least, dihedrals(mesh).least + 15);
  EXPECT_LT(dihedrals(result.mesh).greatest, dihedrals(mesh).greatest);
  EXPECT_NEAR(whole_volume6(result.mesh), whole_volume6(mesh), 1e-10 * whole_volume6(mesh));
  EXPECT_EQ(result.surface.triangles.size(), mesh.boundary.size());
  EXPECT_EQ(result.mesh.boundary.size(), mesh.boundary.size());
  for (std::size_t t = 0; t < mesh.boundary.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      ASSERT_EQ(result.mesh.points[result.mesh.boundary[t][k]], mesh.points[mesh.boundary[t][k]]);
    }
  }
}

TEST(Improve, SliverWithAllFourPointsOnTheBoundary) {
  const TetMesh mesh = test::octahedron_with_sliver(0.01);
  ASSERT_LT(dihedrals(mesh).least, 2);
  const ImproveResult result = improve(mesh, {}, fixed(), {});
  expect_sound(result.mesh);
  EXPECT_GT(dihedrals(result.mesh).least, 30);
}

TEST(Improve, RegionsStayWhatTheyAre) {
  const TetMesh mesh = bricks(4, 0.4, 22, 2);
  const ImproveResult result = improve(mesh, {}, fixed(), {});
  for (const std::int32_t region : {1, 2}) {
    double before = 0, after = 0;
    for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
      before += mesh.region[t] == region ? test::volume6(mesh, mesh.tets[t]) : 0;
    }
    for (std::size_t t = 0; t < result.mesh.tets.size(); ++t) {
      after += result.mesh.region[t] == region ? test::volume6(result.mesh, result.mesh.tets[t]) : 0;
    }
    EXPECT_NEAR(after, before, 1e-10 * before);
  }
}

TEST(Improve, SlidingKeepsTheSurfaceWithinItsLimits) {
  const SurfaceMesh surface = shell();
  const TetMesh mesh = tetrahedralize(surface, {}, test::worker_context());
  ImproveOptions options;
  options.tolerance = Length::mm(0.12);
  const ImproveResult still = improve(mesh, {nullptr, nullptr, &surface}, fixed(), {});
  const ImproveResult result = improve(mesh, {nullptr, nullptr, &surface}, options, {});
  expect_sound(result.mesh);
  EXPECT_GT(dihedrals(result.mesh).least, dihedrals(still.mesh).least + 2);
  EXPECT_EQ(still.surface.points, surface.points);
  EXPECT_NE(result.surface.points, surface.points);
  EXPECT_EQ(result.surface.triangles, surface.triangles);

  const TwoSidedDistance distance = two_sided_distance(result.surface, surface, {}, {});
  EXPECT_GT(distance.forward.summary.max, 0.01) << "something slid";
  EXPECT_LE(distance.forward.summary.max, 0.12);
  EXPECT_LE(distance.backward.summary.max, 0.12);
  EXPECT_TRUE(self_intersections(result.surface, {}).empty());
  for (const Triangle& t : surface.triangles) {
    const auto normal = [&](const SurfaceMesh& s) {
      return normalized(cross(s.points[t[1]] - s.points[t[0]], s.points[t[2]] - s.points[t[0]]));
    };
    EXPECT_GT(dot(normal(surface), normal(result.surface)), 0.9396) << "20 degrees";
  }
  for (std::size_t p = 0; p < result.surface.points.size(); ++p) {
    ASSERT_EQ(result.surface.points[p], result.mesh.points[p]) << "the mesh has the same surface";
  }
}

TEST(Improve, OnePercentDoesNotStayShortWhereTheBoundaryHasRoom) {
  const SurfaceMesh surface = shell();
  const TetMesh mesh = tetrahedralize(surface, {}, test::worker_context());
  ImproveOptions options;
  options.tolerance = Length::mm(0.16);
  const ImproveResult result = improve(mesh, {nullptr, nullptr, &surface}, options, {});
  expect_sound(result.mesh);
  EXPECT_LT(test::first_percentile(mesh), 20);
  EXPECT_GT(test::first_percentile(result.mesh), 28.5);
  EXPECT_LE(two_sided_distance(result.surface, surface, {}, {}).forward.summary.max, 0.16);
}

TEST(Improve, TheWallOfAFilledCavityStaysInTheSurface) {
  const SurfaceMesh surface = shell();
  TetgenOptions tetgen;
  tetgen.cavities = Cavities::kFilled;
  const TetMesh mesh = tetrahedralize(surface, tetgen, test::worker_context());
  ASSERT_EQ(*std::max_element(mesh.region.begin(), mesh.region.end()), 2);
  const ImproveResult result = improve(mesh, {nullptr, nullptr, &surface}, fixed(), {});
  EXPECT_EQ(result.surface.triangles, surface.triangles);
  EXPECT_EQ(result.surface.points, surface.points);
  EXPECT_GE(dihedrals(result.mesh).least, dihedrals(mesh).least);
  const auto volume_of_cavity = [](const TetMesh& m) {
    double sum = 0;
    for (std::size_t t = 0; t < m.tets.size(); ++t) {
      const auto& [a, b, c, d] = m.tets[t];
      if (m.region[t] == 2) sum += six_volumes(m.points[a], m.points[b], m.points[c], m.points[d]);
    }
    return sum;
  };
  EXPECT_NEAR(volume_of_cavity(result.mesh), volume_of_cavity(mesh), 1e-9 * volume_of_cavity(mesh));
}

TEST(Improve, SameBitsForAnyNumberOfThreads) {
  const SurfaceMesh surface = shell();
  const TetMesh mesh = tetrahedralize(surface, {}, test::worker_context());
  ImproveOptions options;
  options.tolerance = Length::mm(0.1);
  const ImproveResult first = improve(mesh, {nullptr, nullptr, &surface}, options, {});
  EXPECT_NE(first.surface.points, surface.points) << "something slides";
  for (const int threads : {2, 4}) {
    Context several;
    several.threads = threads;
    const ImproveResult second = improve(mesh, {nullptr, nullptr, &surface}, options, several);
    EXPECT_EQ(first.mesh.points, second.mesh.points);
    EXPECT_EQ(first.mesh.tets, second.mesh.tets);
    EXPECT_EQ(first.mesh.region, second.mesh.region);
    EXPECT_EQ(first.surface.points, second.surface.points);
  }
}

TEST(Improve, WithoutAToleranceNothingSlides) {
  const SurfaceMesh surface = shell();
  const TetMesh mesh = tetrahedralize(surface, {}, test::worker_context());
  EXPECT_EQ(improve(mesh, {nullptr, nullptr, &surface}, {}, {}).surface.points, surface.points);
}

TEST(Improve, TheDecimatorsDistanceIsTheTolerance) {
  const SurfaceMesh surface = shell();
  const TetMesh mesh = tetrahedralize(surface, {}, test::worker_context());
  SimplexMesh decimated;
  decimated.report.requested_distance_mm = 0.12;
  ImproveOptions options;
  options.tolerance = Length::mm(0.12);
  EXPECT_EQ(improve(mesh, {nullptr, &decimated, &surface}, {}, {}).surface.points,
            improve(mesh, {nullptr, nullptr, &surface}, options, {}).surface.points);
}

TEST(Improve, GrowthIsLimited) {
  const TetMesh mesh = bricks(6, 0.48, 23);
  ImproveOptions options = fixed();
  options.target = Angle::deg(45);
  options.max_growth = 0.03;
  const ImproveResult result = improve(mesh, {}, options, {});
  EXPECT_LE(static_cast<double>(result.mesh.tets.size()), 1.03 * static_cast<double>(mesh.tets.size()));
}

TEST(Improve, SecondOrderGetsItsNodesAnew) {
  const TetMesh linear = bricks(4, 0.4, 24);
  TetMesh mesh = linear;
  add_midside_nodes(mesh);
  const ImproveResult result = improve(mesh, {}, fixed(), {});
  ASSERT_EQ(result.mesh.order(), 2);
  const ImproveResult expected = improve(linear, {}, fixed(), {});
  EXPECT_EQ(result.mesh.tets, expected.mesh.tets) << "mid-side nodes do not matter";
  for (std::size_t t = 0; t < result.mesh.tets.size(); ++t) {
    for (std::size_t k = 0; k < 6; ++k) {
      const Vec3 a = result.mesh.points[result.mesh.tets[t][static_cast<std::size_t>(kTetEdge[k][0])]];
      const Vec3 b = result.mesh.points[result.mesh.tets[t][static_cast<std::size_t>(kTetEdge[k][1])]];
      ASSERT_EQ(result.mesh.points[result.mesh.midside[t][k]], 0.5 * (a + b));
    }
  }
}

TEST(Improve, ThinWallsGetPointsInside) {
  const TetMesh mesh = bricks(1, 0, 0);
  ImproveOptions options = fixed();
  options.split_thin = true;
  options.max_growth = 1;
  const ImproveResult result = improve(mesh, {}, options, {});
  expect_sound(result.mesh);
  EXPECT_GT(result.mesh.points.size(), mesh.points.size());
  EXPECT_GE(dihedrals(result.mesh).least, 20);
}

std::string code_of(const TetMesh& mesh, const ImproveOptions& options) {
  try {
    improve(mesh, {}, options, {});
  } catch (const Error& error) {
    return error.code();
  }
  return "no error";
}

TEST(Improve, InvalidInput) {
  TetMesh mesh = bricks(2, 0.1, 25);
  ImproveOptions options;
  options.tolerance = Length::voxel(0.3);
  EXPECT_EQ(code_of(mesh, options), "improve.no_voxel");
  std::swap(mesh.tets[5][0], mesh.tets[5][1]);
  EXPECT_EQ(code_of(mesh, fixed()), "improve.inverted");
  EXPECT_TRUE(improve(TetMesh{}, {}, fixed(), {}).mesh.tets.empty());
}

TEST(Improve, StopsWhenCancelled) {
  const std::atomic<bool> is_cancelled{true};
  Context context;
  context.cancelled = &is_cancelled;
  EXPECT_THROW(improve(bricks(3, 0.4, 26), {}, fixed(), context), Error);
}

}  // namespace
}  // namespace periost
