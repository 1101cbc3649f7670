// Sizes asked for and sizes reached. "Length" below is that of edges with an end inside the body.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "pipeline/base/error.h"
#include "pipeline/io/image_write.h"
#include "stages/tetgen/reached.h"
#include "stages/tetgen/sizes.h"
#include "tests/support/fit_for_mechanics.h"
#include "tests/support/process.h"
#include "tests/support/surfaces.h"
#include "tests/unit/stages/tetgen/worker_context.h"

namespace periost {
namespace {

using periost_tetgen::size_at;
using periost_tetgen::SizeGrid;

const Vec3 kCentre{35, -120, 410};
constexpr double kRadius = 20;

SurfaceMesh ball(int levels) {
  return test::sphere_surface(kCentre, kRadius, levels);
}

// Median length of the edges whose middle a condition holds for.
template <class Where>
double median_edge(const TetMesh& mesh, std::size_t surface_points, Where where) {
  std::set<std::pair<Index, Index>> edges;
  for (const Tetrahedron& tet : mesh.tets) {
    for (const Index a : tet) {
      for (const Index b : tet) {
        if (a < b && b >= surface_points) edges.insert({a, b});
      }
    }
  }
  std::vector<double> lengths;
  for (const auto& [a, b] : edges) {
    if (where(0.5 * (mesh.points[a] + mesh.points[b])))
      lengths.push_back(distance(mesh.points[a], mesh.points[b]));
  }
  if (lengths.empty()) return 0;
  std::nth_element(lengths.begin(), lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2),
                   lengths.end());
  return lengths[lengths.size() / 2];
}

// The same, left in the test's record under `name`.
template <class Where>
double recorded_edge(const char* name, const TetMesh& mesh, std::size_t surface_points, Where where) {
  const double edge = median_edge(mesh, surface_points, where);
  testing::Test::RecordProperty(name, std::to_string(edge));
  return edge;
}

double depth(Vec3 p) {
  return kRadius - distance(p, kCentre);
}

TEST(TetgenSizes, FineAtTheSurfaceAndCoarseInside) {
  const SurfaceMesh surface = ball(4);  // edges of about 1.4 mm
  TetgenOptions options;
  options.sizes.inside = Length::mm(5);
  options.sizes.gradation = 0.3;
  const TetMesh graded = tetrahedralize(surface, options, test::worker_context());
  EXPECT_TRUE(graded.boundary_preserved);
  test::expect_fit_for_mechanics(graded);
  const auto near = [](Vec3 p) { return depth(p) < 2; };
  const auto far = [](Vec3 p) { return depth(p) > 14; };
  const double near_edge = recorded_edge("near", graded, surface.points.size(), near);
  const double far_edge = recorded_edge("far", graded, surface.points.size(), far);
  // Edges that are refined until the longest is short enough end between a half and all of what was asked.
  EXPECT_GT(near_edge, 0.5 * 1.4);
  EXPECT_LT(near_edge, 1.2 * 1.9);
  EXPECT_GT(far_edge, 0.5 * 5);
  EXPECT_LT(far_edge, 5);
  options.sizes.inside = Length::mm(2);
  const TetMesh fine = tetrahedralize(surface, options, test::worker_context());
  const double fine_edge = recorded_edge("fine", fine, surface.points.size(), far);
  EXPECT_GT(fine_edge, 0.5 * 2);
  EXPECT_LT(fine_edge, 2);
  EXPECT_GT(fine.tets.size(), 2 * graded.tets.size());
}

TEST(TetgenSizes, FineAroundAPointInEitherFrame) {
  const SurfaceMesh surface = ball(3);  // edges of about 2.8 mm
  TetgenOptions options;
  options.sizes.around = {{.at = kCentre, .radius = Length::mm(4), .size = Length::mm(1)}};
  const TetMesh mesh = tetrahedralize(surface, options, test::worker_context());
  const auto inside = [](Vec3 p) { return distance(p, kCentre) < 3.5; };
  const auto outside = [](Vec3 p) { return distance(p, kCentre) > 12; };
  const double fine = recorded_edge("fine", mesh, surface.points.size(), inside);
  const double coarse = recorded_edge("coarse", mesh, surface.points.size(), outside);
  EXPECT_GT(fine, 0.5);
  EXPECT_LT(fine, 1);
  EXPECT_GT(coarse, 2);
  options.sizes.around[0].at = {-kCentre.x, -kCentre.y, kCentre.z};
  options.sizes.around[0].frame = SizeFrame::kRas;
  EXPECT_EQ(tetrahedralize(surface, options, test::worker_context()).tets, mesh.tets);
}

TEST(TetgenSizes, AFieldOfSizesOnAnObliqueGrid) {
  const test::TemporaryFolder folder;
  // Left half 2 mm, right half 5 mm, nothing asked for outside; the image is turned and left-handed.
  Image field;
  field.frame.dims = {30, 30, 30};
  field.frame.spacing = {2, 2.5, 3};
  field.frame.direction.column = {Vec3{0.6, 0.8, 0}, Vec3{0.8, -0.6, 0}, Vec3{0, 0, 1}};
  field.frame.origin = kCentre - field.frame.direction * Vec3{29, 36.25, 43.5};
  field.values.assign(field.frame.voxel_count(), 0);
  for (std::int32_t k = 0; k < 30; ++k) {
    for (std::int32_t j = 0; j < 30; ++j) {
      for (std::int32_t i = 0; i < 30; ++i) {
        const Vec3 p = field.frame.to_lps({double(i), double(j), double(k)});
        if (distance(p, kCentre) < kRadius + 6)
          field.values[field.frame.offset(i, j, k)] = p.x < kCentre.x ? 2 : 5;
      }
    }
  }
  TetgenOptions options;
  options.sizes.field = folder.path() / "sizes.nrrd";
  options.sizes.gradation = 1;
  write_image(options.sizes.field, field);
  const SurfaceMesh surface = ball(3);
  const TetMesh mesh = tetrahedralize(surface, options, test::worker_context());
  const auto left = [](Vec3 p) { return p.x < kCentre.x - 3 && depth(p) > 4; };
  const auto right = [](Vec3 p) { return p.x > kCentre.x + 7 && depth(p) > 4; };
  const double fine = recorded_edge("fine", mesh, surface.points.size(), left);
  const double coarse = recorded_edge("coarse", mesh, surface.points.size(), right);
  EXPECT_GT(fine, 1);
  EXPECT_LT(fine, 2);
  EXPECT_GT(coarse, 2.5);
  EXPECT_LT(coarse, 5);

  field.values.assign(field.values.size(), 0);
  write_image(options.sizes.field, field);
  EXPECT_THROW(tetrahedralize(surface, options, test::worker_context()), Error);
}

TEST(TetgenSizes, AllEdgesKeepNearlyWhatWasAsked) {
  const SurfaceMesh surface = ball(4);
  TetgenOptions options;
  options.sizes.inside = Length::mm(4);
  std::string said;
  Context context = test::worker_context();
  const TetMesh mesh = tetrahedralize(surface, options, context);
  const SizeGrid grid = make_size_grid(surface, {}, options, nullptr, context);
  const SizeReached reached = sizes_reached(mesh.points, mesh.tets, surface.points.size(), grid);
  EXPECT_GT(reached.edges, 1000U);
  RecordProperty("median", std::to_string(reached.median));
  RecordProperty("p99", std::to_string(reached.p99));
  EXPECT_GT(reached.median, 0.5);
  EXPECT_LT(reached.median, 0.95);
  EXPECT_LT(reached.p99, 1.15);
}

TEST(TetgenSizes, TheGridGrowsByGradationAndNeverFaster) {
  const SurfaceMesh surface = test::box_surface({-10, -10, -10}, {10, 10, 10});
  TetgenOptions options;
  options.preserve_surface = false;
  options.sizes.inside = Length::mm(8);
  options.sizes.near_surface = Length::mm(2);
  options.sizes.gradation = 0.5;
  const SizeGrid grid = make_size_grid(surface, {}, options, nullptr, {});
  // Between the exact law and a chamfer's detour of a tenth, from the layer of nodes at the surface on.
  for (const double x : {0.0, 4.0, 7.0, 9.5}) {
    const double at[3] = {x, 1, -2};
    const double law = 2 + 0.5 * std::min(10 - x, 8.0);
    EXPECT_LE(size_at(grid, at), law + 1e-5) << x;
    EXPECT_GE(size_at(grid, at), law - 0.5 * 1.75 * grid.spacing) << x;
  }
  const auto n = grid.nodes;
  for (std::size_t node = 0; node + 1 < grid.values.size(); ++node) {
    if ((node + 1) % n[0] == 0) continue;
    EXPECT_LE(std::abs(grid.values[node + 1] - grid.values[node]), 0.5 * grid.spacing + 1e-5);
  }
  // A kept surface of twelve triangles cannot be refined, so nothing is asked for at it.
  options.preserve_surface = true;
  const double corner[3] = {10, 10, 10}, middle[3] = {0, 0, 0};
  const SizeGrid kept = make_size_grid(surface, {}, options, nullptr, {});
  EXPECT_GE(size_at(kept, corner), 20 * 1.41);
  EXPECT_LT(size_at(kept, middle), size_at(kept, corner));
}

}  // namespace
}  // namespace periost
