// The certified scheme by pieces: the promises of the whole, and nearly its rate.
#include <gtest/gtest.h>

#include <algorithm>

#include "certified_shapes.h"
#include "pipeline/base/error.h"
#include "pipeline/geometry/self_intersection.h"
#include "pipeline/geometry/simplex_dual.h"
#include "pipeline/geometry/surface_distance.h"
#include "pipeline/geometry/topology.h"
#include "stages/decimate/certified.h"
#include "stages/decimate/certified_pieces.h"

namespace periost::certified_pieces_test {
namespace {

// A long body with a hole and a small ball beside it, over a seam.
Isosurface body() {
  return shapes::isosurface_of({34, 30, 70}, [](Vec3 p) {
    const double tube = 9 - std::abs(std::hypot(p.x - 16.4 - 2 * std::sin(0.1 * p.z), p.y - 14.7) - 0.5);
    const double ends = 31 - std::abs(p.z - 34.6), hole = std::hypot(p.x - 16, p.z - 36) - 4;
    const double ball = 2.2 - norm(p - Vec3{3, 3.2, 35});
    return std::max(std::min({tube, ends, hole}), ball);
  });
}

SurfaceMesh decimated(const Isosurface& isosurface, const DecimateOptions& options, SimplexMesh& mesh,
                      int threads = 1) {
  Context context;
  context.threads = threads;
  mesh = decimate(isosurface, options, context);
  return dual_triangulation(mesh);
}

void expect_promises(const Isosurface& isosurface, const SurfaceMesh& result, double tolerance,
                     bool is_closed) {
  const Topology before = examine_topology(isosurface.surface), after = examine_topology(result);
  EXPECT_EQ(after.is_closed(), is_closed);
  EXPECT_TRUE(after.is_manifold());
  EXPECT_TRUE(after.is_oriented());
  EXPECT_EQ(after.euler, before.euler);
  EXPECT_EQ(after.components, before.components);
  EXPECT_TRUE(self_intersections(result, Context{}).empty());
  const auto distances = two_sided_distance(result, isosurface.surface, {}, Context{});
  EXPECT_LE(distances.forward.summary.max, tolerance);
  EXPECT_LE(distances.backward.summary.max, tolerance);
}

TEST(CertifiedPieces, KeepThePromisesOfTheWholeAndNearlyItsRate) {
  const Isosurface isosurface = body();
  DecimateOptions options;
  const double tolerance = options.distance.in_mm(isosurface.frame.largest_spacing());
  SimplexMesh whole, mesh;
  decimated(isosurface, options, whole);
  for (const int pieces : {2, 3}) {
    options.pieces = pieces;
    const SurfaceMesh result = decimated(isosurface, options, mesh);
    EXPECT_EQ(mesh.report.pieces, static_cast<std::uint32_t>(pieces));
    expect_promises(isosurface, result, tolerance, true);
    EXPECT_EQ(check_simplex_mesh(mesh), "");
    EXPECT_GE(mesh.report.rate(), whole.report.rate() - 0.02) << "slabs are hardly wider than triangles";
    EXPECT_EQ(mesh.face_fields.at("blocked_by").size(), mesh.dual_position.size());
  }
}

TEST(CertifiedPieces, CanDoWithoutAReverseDistance) {
  const Isosurface isosurface = body();
  DecimateOptions options;
  options.pieces = 2;
  options.reverse = ReverseDistance::kNone;
  SimplexMesh mesh;
  const SurfaceMesh result = decimated(isosurface, options, mesh);
  EXPECT_TRUE(examine_topology(result).is_closed());
  EXPECT_TRUE(self_intersections(result, Context{}).empty());
  EXPECT_LE(two_sided_distance(result, isosurface.surface, {}, Context{}).forward.summary.max,
            options.distance.in_mm(isosurface.frame.largest_spacing()));
}

TEST(CertifiedPieces, HaveTheSameBitsOnAnyNumberOfThreads) {
  const Isosurface isosurface = body();
  DecimateOptions options;
  options.pieces = 2;
  SimplexMesh mesh;
  const SurfaceMesh one = decimated(isosurface, options, mesh, 1);
  for (const int threads : {2, 4}) {
    const SurfaceMesh other = decimated(isosurface, options, mesh, threads);
    EXPECT_EQ(one.points, other.points) << threads;
    EXPECT_EQ(one.triangles, other.triangles) << threads;
  }
}

TEST(CertifiedPieces, HaveTheSameBitsInAnyOrder) {
  const Isosurface isosurface = shapes::ellipsoid();
  DecimateOptions options;
  options.distance = Length::voxel(0.1);
  for (const std::size_t most : {0, 700}) {
    options.max_triangles = most;
    Context context;
    const SurfaceMesh ascending =
        dual_triangulation(decimate_certified_in_pieces(isosurface, 3, options, context));
    for (const std::uint64_t seed : {1, 2}) {
      const SurfaceMesh shuffled =
          dual_triangulation(decimate_certified_in_pieces(isosurface, 3, options, context, seed));
      EXPECT_EQ(ascending.points, shuffled.points) << seed;
      EXPECT_EQ(ascending.triangles, shuffled.triangles) << seed;
    }
  }
}

// A closed rod that fills the image from its first slice to its last: its caps lie beyond these.
TEST(CertifiedPieces, ThinOutCapsAtTheImageBorder) {
  const Isosurface isosurface = shapes::isosurface_of(
      {30, 50, 12}, [](Vec3 p) { return 11 - std::hypot(p.x - 14.6, 0.5 * (p.y - 24.2)); });
  DecimateOptions options;
  options.distance = Length::voxel(0.1);
  const auto on_caps = [&](const SurfaceMesh& surface) {
    return std::count_if(surface.triangles.begin(), surface.triangles.end(), [&](const Triangle& t) {
      const Vec3 centre = (surface.points[t[0]] + surface.points[t[1]] + surface.points[t[2]]) / 3;
      const double k = isosurface.frame.to_index(centre).z;
      return k < 0.1 || k > 10.9;
    });
  };
  SimplexMesh mesh;
  const auto whole = on_caps(decimated(isosurface, options, mesh));
  options.pieces = 2;
  EXPECT_LE(static_cast<double>(on_caps(decimated(isosurface, options, mesh))),
            1.2 * static_cast<double>(whole));
}

TEST(CertifiedPieces, OfNoiseAndOfOpenSurfacesKeepTheirPromises) {
  DecimateOptions options;
  options.pieces = 2;
  SimplexMesh mesh;
  const Isosurface noise = shapes::white_noise(11);
  expect_promises(noise, decimated(noise, options, mesh), 0.3 * noise.frame.largest_spacing(), true);

  Image image{shapes::oblique_frame({26, 24, 40}), {}};
  for (int k = 0; k < 40; ++k) {
    for (int j = 0; j < 24; ++j) {
      for (int i = 0; i < 26; ++i)
        image.values.push_back(static_cast<float>(8.3 - std::hypot(i - 11.6, j - 9.0 - 0.05 * k)));
    }
  }
  ThresholdRange range;
  range.lower = 0;
  const Isosurface tube = marching_cubes(image, range, {.open = true}, Context{});
  expect_promises(tube, decimated(tube, options, mesh), 0.3 * tube.frame.largest_spacing(), false);
  EXPECT_GT(mesh.report.rate(), 0.8);
}

TEST(CertifiedPieces, DropComponentsThatAreSmallAsAWhole) {
  const Isosurface isosurface = body();
  DecimateOptions options;
  options.pieces = 2;
  options.small_components = SmallComponents::kDrop;
  options.small_triangles = 400;
  SimplexMesh mesh;
  const Topology before = examine_topology(isosurface.surface);
  EXPECT_EQ(examine_topology(decimated(isosurface, options, mesh)).components, before.components - 1);
}

TEST(CertifiedPieces, FollowFromTheBudget) {
  const Isosurface isosurface = body();
  Context context;
  EXPECT_EQ(pieces_within(isosurface, context), 1u);
  context.memory_bytes = std::uint64_t{1} << 30;
  EXPECT_EQ(pieces_within(isosurface, context), 1u);
  context.memory_bytes = 1 << 20;
  try {
    pieces_within(isosurface, context);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kLimit);
    std::uint64_t least = 0;
    ASSERT_EQ(std::sscanf(error.hint().c_str(), "allow at least --memory %luMiB", &least), 1) << error.hint();
    context.memory_bytes = least << 20;
    EXPECT_GE(pieces_within(isosurface, context), 1u) << "what it asks for is enough";
  }
}

}  // namespace
}  // namespace periost::certified_pieces_test
