// Decimation by pieces: cut, decimated apart, sewn.
#include "stages/decimate/pieces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "pipeline/geometry/isosurface_query.h"
#include "pipeline/geometry/simplex_dual.h"
#include "pipeline/geometry/topology.h"
#include "stages/marching_cubes/marching_cubes.h"
#include "stages/phantom/phantom.h"
#include "tests/unit/stages/decimate/paper_decimation.h"
#include "tests/unit/stages/decimate/phantoms.h"

namespace periost {
namespace {

using test::paper_options;
using test::same_bits;

// A small tree of vessels, grey, in a left-handed oblique anisotropic grid.
Isosurface vessel() {
  Context context;
  PhantomOptions options;
  options.shape = PhantomShape::kVessel;
  options.size = {48, 48, 40};
  options.spacing = Vec3{0.7, 0.7, 1.2};
  options.origin = {-20, 31, 400};
  options.direction = {0.8, 0.6, 0, -0.6, 0.8, 0, 0, 0, -1};
  return marching_cubes(make_phantom(options, context), {.lower = 190}, {.keep = {1}}, context);
}

TEST(Pieces, AVesselCutAlongThreePlanesIsOneClosedMeshAgain) {
  const Isosurface whole = vessel();
  Context context;
  DecimateOptions options = paper_options(4);
  const SimplexMesh mesh = decimate(whole, options, context);
  EXPECT_EQ(mesh.report.pieces, 4u);
  EXPECT_EQ(check_simplex_mesh(mesh), "");
  EXPECT_EQ(components_of(mesh).count, 1u);
  EXPECT_EQ(euler_number(mesh), euler_number(dual_simplex_mesh(whole.surface)));
  const Topology topology = examine_topology(dual_triangulation(mesh));
  EXPECT_TRUE(topology.is_closed());
  EXPECT_TRUE(topology.is_manifold());
  EXPECT_TRUE(topology.is_oriented());
  EXPECT_EQ(mesh.report.triangles_before, whole.surface.triangles.size());
  // The distance criterion holds across the seams, too.
  const double tolerance = 0.4 * 1.2;
  for (const Vec3 p : mesh.position) {
    const auto closest = closest_point(whole, p, 3 * tolerance);
    ASSERT_TRUE(closest);
    EXPECT_LE(closest->distance, tolerance * (1 + 1e-9));
  }
  // Cutting costs a few triangles at most.
  options.pieces = 1;
  const SimplexMesh uncut = decimate(whole, options, context);
  EXPECT_EQ(uncut.report.pieces, 1u);
  EXPECT_GT(mesh.report.rate(), uncut.report.rate() - 0.01);
}

TEST(Pieces, TheOrderOfPiecesAndThreadsChangesNoBit) {
  const Isosurface whole = vessel();
  Context one, two;
  two.threads = 2;
  const DecimateOptions options = paper_options(4);
  const SimplexMesh mesh = decimate(whole, options, one);
  EXPECT_TRUE(same_bits(mesh, decimate(whole, options, two)));
  const CutPlanes planes = choose_cut(whole, 4);
  const double distance_mm = options.distance.in_mm(whole.surface.voxel_mm);
  std::vector<Piece> pieces(4);
  for (const std::size_t i : {2u, 0u, 3u, 1u})
    pieces[i] = decimate_piece(whole, planes, i, options, distance_mm, 0, one);
  EXPECT_TRUE(same_bits(mesh, join_pieces(whole, std::move(pieces), options, distance_mm, 0, one)));
}

TEST(Pieces, AnOpenSurfaceIsCutThroughItsContours) {
  Mask mask;
  mask.frame.dims = {24, 24, 40};
  mask.frame.origin = {-40, 12.5, 333};
  for (std::int32_t k = 0; k < 40; ++k) {
    for (std::int32_t j = 0; j < 24; ++j) {
      // A half pipe that leaves through the ends of k and through i = 0.
      for (std::int32_t i = 0; i < 24; ++i)
        mask.inside.push_back(std::hypot(i + 1.0, j - 12.0) <= 9.4 ? 1 : 0);
    }
  }
  const Isosurface whole = marching_cubes(nullptr, mask, {.open = true}, Context());
  Context context;
  for (const int pieces : {2, 3, 5}) {
    const SimplexMesh mesh = decimate(whole, paper_options(pieces), context);
    EXPECT_EQ(check_simplex_mesh(mesh), "");
    EXPECT_EQ(components_of(mesh).count, 1u);
    EXPECT_EQ(euler_number(mesh), euler_number(dual_simplex_mesh(whole.surface)));
    EXPECT_GT(mesh.report.rate(), 0.7);
    const SurfaceMesh surface = dual_triangulation(mesh);
    EXPECT_TRUE(examine_topology(surface).is_manifold());
    const auto neighbours = triangle_neighbours(surface.triangles, surface.points.size());
    for (std::size_t t = 0; t < neighbours.size(); ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        if (neighbours[t][k] != kNoIndex) continue;
        const Vec3 index = whole.frame.to_index(surface.points[surface.triangles[t][(k + 1) % 3]]);
        EXPECT_LT(std::min({std::abs(index.x), std::abs(index.z), std::abs(index.z - 39)}), 1e-9);
      }
    }
  }
}

TEST(Pieces, TinyComponentsAreJudgedWhole) {
  const Isosurface shapes = test::binary_shape(30, {1, 1, 1}, [](Vec3 p) {
    // Two balls, and bars of 2 voxels across every plane of a cut.
    const bool is_bar =
        std::abs(p.x - 12.5) < 0.1 && std::abs(p.y - 12.5) < 0.1 && std::fmod(p.z + 40.5, 3) < 1.5;
    return norm(p - Vec3{-5, -5, -7}) <= 6 || norm(p - Vec3{-4, 4, 7}) <= 7 || is_bar;
  });
  Context context;
  DecimateOptions options = paper_options(3);
  const SimplexMesh original = dual_simplex_mesh(shapes.surface);
  const std::uint32_t components = components_of(original).count;
  ASSERT_GT(components, 8u);
  const SimplexMesh kept = decimate(shapes, options, context);
  EXPECT_EQ(components_of(kept).count, components);
  EXPECT_EQ(euler_number(kept), euler_number(original));
  std::size_t untouched = 0, small = 0;
  const SimplexComponents before = components_of(original);
  std::vector<int> size(components, 0);
  for (const std::uint32_t c : before.of_vertex) ++size[c];
  for (std::size_t v = 0; v < original.position.size(); ++v) {
    if (size[before.of_vertex[v]] >= 100) continue;
    ++small;
    untouched += std::count(kept.position.begin(), kept.position.end(), original.position[v]) > 0 ? 1u : 0u;
  }
  EXPECT_EQ(untouched, small);
  EXPECT_GT(small, 100u);
  options.small_components = SmallComponents::kDrop;
  const SimplexMesh dropped = decimate(shapes, options, context);
  EXPECT_EQ(components_of(dropped).count, 2u);
  EXPECT_EQ(euler_number(dropped), 4);
}

TEST(Pieces, MorePiecesThanPlanesAndSurfacesOffTheCutAreFine) {
  const Isosurface balls = test::two_balls();
  Context context;
  for (const int pieces : {2, 12, 500}) {
    const SimplexMesh mesh = decimate(balls, paper_options(pieces), context);
    EXPECT_EQ(check_simplex_mesh(mesh), "");
    EXPECT_EQ(components_of(mesh).count, 2u);
    EXPECT_EQ(euler_number(mesh), 4);
    EXPECT_GT(mesh.report.rate(), pieces < 20 ? 0.7 : 0.3);
  }
}

}  // namespace
}  // namespace periost
