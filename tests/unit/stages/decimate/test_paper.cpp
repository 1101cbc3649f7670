#include <gtest/gtest.h>

#include "pipeline/base/error.h"
#include "pipeline/geometry/isosurface_query.h"
#include "pipeline/geometry/simplex_dual.h"
#include "stages/decimate/criteria.h"
#include "stages/decimate/decimate.h"
#include "tests/unit/stages/decimate/paper_decimation.h"
#include "tests/unit/stages/decimate/phantoms.h"

namespace periost {
namespace {

using test::paper_options;
using test::same_bits;

// What section 4.1 promises, on a surface whose start keeps the distance criterion everywhere.
void expect_criteria(const Isosurface& isosurface, const SimplexMesh& mesh, double distance_mm) {
  EXPECT_EQ(check_simplex_mesh(mesh), "");
  std::size_t thin = 0;
  for (std::uint32_t v = 0; v < mesh.face.size(); ++v) {
    const auto closest = closest_point(isosurface, mesh.position[v], 3 * distance_mm);
    ASSERT_TRUE(closest);
    EXPECT_LE(closest->distance, distance_mm * (1 + 1e-9));
    thin += barycentric_deficit(mesh, SimplexVertex{v}, 0.1) > 0 ? 1 : 0;
  }
  EXPECT_LE(thin, mesh.face.size() / 50) << "vertices with a barycentric coordinate under 0.1";
  for (std::uint32_t f = 0; f < mesh.valence.size(); ++f) {
    const auto closest = closest_point(isosurface, face_centre(mesh, SimplexFace{f}), 3 * distance_mm);
    ASSERT_TRUE(closest);
    EXPECT_LE(closest->distance, distance_mm * (1 + 1e-9));
    EXPECT_EQ(mesh.dual_position[f], face_centre(mesh, SimplexFace{f}));
    EXPECT_GE(mesh.valence[f], 3u);
    EXPECT_LE(mesh.valence[f], kMostVerticesOfAFace);
  }
}

TEST(DecimatePaper, KeepsItsCriteriaAndTheTopology) {
  const Isosurface torus = test::binary_torus(14, 6);
  Context context;
  const SimplexMesh mesh = decimate(torus, paper_options(), context);
  expect_criteria(torus, mesh, 0.4);
  EXPECT_EQ(euler_number(mesh), 0);
  EXPECT_GT(mesh.report.rate(), 0.7);
  EXPECT_EQ(mesh.report.triangles_before, torus.surface.triangles.size());
  EXPECT_EQ(mesh.report.triangles_after, mesh.face.size());
  EXPECT_EQ(mesh.report.triangles_before - mesh.report.triangles_after, 2 * mesh.report.removals);
  EXPECT_DOUBLE_EQ(mesh.report.requested_distance_mm, 0.4);
}

TEST(DecimatePaper, AnisotropicVoxelsCountByTheirLargestSide) {
  const Isosurface ball = test::binary_ball(12, {0.5, 0.5, 1.5});
  DecimateOptions options = paper_options();
  Context context;
  const SimplexMesh mesh = decimate(ball, options, context);
  EXPECT_DOUBLE_EQ(mesh.report.requested_distance_mm, 0.6);
  expect_criteria(ball, mesh, 0.6);
  options.distance = Length::mm(0.6);
  EXPECT_TRUE(same_bits(decimate(ball, options, context), mesh));
}

TEST(DecimatePaper, EachComponentByItselfWithTheSameBitsOnAnyNumberOfThreads) {
  const Isosurface balls = test::two_balls();
  Context one, two;
  two.threads = 2;
  const SimplexMesh mesh = decimate(balls, paper_options(), one);
  EXPECT_EQ(components_of(mesh).count, 2u);
  EXPECT_EQ(euler_number(mesh), 4);
  EXPECT_TRUE(same_bits(mesh, decimate(balls, paper_options(), two)));
}

TEST(DecimatePaper, TheSeedDecidesAndTheRunsSeedIsTheDefault) {
  const Isosurface ball = test::binary_ball(9);
  Context context;
  context.seed = 5;
  DecimateOptions options = paper_options();
  const SimplexMesh by_run = decimate(ball, options, context);
  options.seed = 5;
  context.seed = 77;
  EXPECT_TRUE(same_bits(by_run, decimate(ball, options, context)));
  options.seed = 6;
  EXPECT_FALSE(same_bits(by_run, decimate(ball, options, context)));
}

TEST(DecimatePaper, SmallComponentsAreKeptOrDropped) {
  const Isosurface shapes = test::binary_shape(30, {1, 1, 1}, [](Vec3 p) {
    return norm(p) <= 7 || norm(p - Vec3{12.5, 12.5, 12.5}) < 0.1;  // a ball and a single voxel
  });
  Context context;
  DecimateOptions options = paper_options();
  const SimplexMesh kept = decimate(shapes, options, context);
  EXPECT_EQ(components_of(kept).count, 2u);
  options.small_components = SmallComponents::kDrop;
  const SimplexMesh dropped = decimate(shapes, options, context);
  EXPECT_EQ(components_of(dropped).count, 1u);
  EXPECT_EQ(check_simplex_mesh(dropped), "");
}

TEST(DecimatePaper, VoxelsOfNothingAreRefused) {
  Context context;
  Isosurface bare = test::binary_ball(8);
  bare.surface.voxel_mm = 0;
  EXPECT_THROW(decimate(bare, paper_options(), context), Error);
}

TEST(DecimatePaper, CancellationStopsIt) {
  const Isosurface ball = test::binary_ball(14);
  std::atomic<bool> cancelled{true};
  Context context;
  context.cancelled = &cancelled;
  EXPECT_THROW(decimate(ball, paper_options(), context), Error);
}

}  // namespace
}  // namespace periost
