// Second-order elements whose boundary follows the isosurface.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "pipeline/geometry/curve_boundary.h"
#include "pipeline/geometry/isosurface_query.h"
#include "pipeline/geometry/measure_volume.h"
#include "pipeline/geometry/tet_faces.h"
#include "pipeline/io/abaqus_deck.h"
#include "stages/marching_cubes/marching_cubes.h"
#include "stages/phantom/phantom.h"
#include "stages/tetgen/tetgen.h"
#include "tests/support/fit_for_mechanics.h"
#include "tests/support/process.h"
#include "tests/support/surfaces.h"
#include "tests/unit/stages/tetgen/worker_context.h"

namespace periost {
namespace {

// A ball as an image on an oblique, left-handed grid, its isosurface, and a coarse mesh of second order whose
// corners on the boundary lie on the isosurface.
class Curved : public testing::Test {
 protected:
  Curved() {
    PhantomOptions phantom;
    phantom.size = {40, 40, 40};
    phantom.spacing = Vec3{1, 1, 1};
    phantom.origin = {-30, 50, 700};
    phantom.direction = {0.6, 0.8, 0, 0.8, -0.6, 0, 0, 0, 1};
    phantom.radius = 15;
    const Image image = make_phantom(phantom, {});
    isosurface_ = marching_cubes(image, {.lower = 500}, {}, {});
    centre_ = image.frame.to_lps({19.5, 19.5, 19.5});
    surface_ = test::sphere_surface(centre_, 15, 2);
    for (Vec3& p : surface_.points) p = closest_point(isosurface_, p, 3)->point;
    TetgenOptions options;
    options.order = 2;
    mesh_ = tetrahedralize(surface_, options, test::worker_context());
  }

  // Mid-side nodes of boundary edges, by the definition.
  std::vector<Index> boundary_nodes() const {
    std::vector<bool> is_boundary(mesh_.points.size(), false);
    std::vector<std::pair<Index, Index>> edges;
    for (const auto& [a, b, c] : mesh_.boundary) {
      for (const auto& edge : {std::minmax(a, b), std::minmax(b, c), std::minmax(c, a)})
        edges.emplace_back(edge);
    }
    std::sort(edges.begin(), edges.end());
    for (std::size_t t = 0; t < mesh_.tets.size(); ++t) {
      for (std::size_t k = 0; k < 6; ++k) {
        const std::pair<Index, Index> edge =
            std::minmax(mesh_.tets[t][static_cast<std::size_t>(kTetEdge[k][0])],
                        mesh_.tets[t][static_cast<std::size_t>(kTetEdge[k][1])]);
        if (std::binary_search(edges.begin(), edges.end(), edge)) is_boundary[mesh_.midside[t][k]] = true;
      }
    }
    std::vector<Index> nodes;
    for (Index p = 0; p < is_boundary.size(); ++p) {
      if (is_boundary[p]) nodes.push_back(p);
    }
    return nodes;
  }
  double largest_distance(const std::vector<Index>& nodes) const {
    double largest = 0;
    for (const Index node : nodes) {
      largest = std::max(largest, closest_point(isosurface_, mesh_.points[node], 10)->distance);
    }
    return largest;
  }
  double smallest_ratio() const {
    WorstElements worst;
    return measure_volume(mesh_, {}, worst).jacobian_ratio->min;
  }

  Isosurface isosurface_;
  Vec3 centre_;
  SurfaceMesh surface_;
  TetMesh mesh_;
};

TEST_F(Curved, TheBoundarysNodesLieOnTheIsosurface) {
  const std::vector<Index> nodes = boundary_nodes();
  EXPECT_EQ(nodes.size(), 3 * mesh_.boundary.size() / 2);
  const TetMesh straight = mesh_;
  const double before = largest_distance(nodes);
  EXPECT_GT(before, 0.15) << "or there is nothing to show";
  const CurveReport report = curve_boundary(mesh_, isosurface_, {}, {});
  RecordProperty("before", std::to_string(before));
  RecordProperty("after", std::to_string(largest_distance(nodes)));
  RecordProperty("ratio", std::to_string(smallest_ratio()));
  EXPECT_EQ(report.nodes, nodes.size());
  EXPECT_EQ(report.moved, nodes.size());
  EXPECT_LT(largest_distance(nodes), 1e-9);
  EXPECT_GE(smallest_ratio(), 0.5);
  test::expect_fit_for_mechanics(mesh_);
  WorstElements worst;
  EXPECT_EQ(measure_volume(mesh_, {}, worst).inverted, 0U);
  // Nothing else moves.
  std::vector<Index> moved;
  for (Index p = 0; p < mesh_.points.size(); ++p) {
    if (mesh_.points[p] != straight.points[p]) moved.push_back(p);
  }
  EXPECT_THAT(moved, testing::IsSubsetOf(nodes));
  EXPECT_EQ(mesh_.midside, straight.midside);
}

TEST_F(Curved, NoElementFallsBelowTheLimit) {
  for (const double limit : {0.7, 0.95}) {
    TetMesh straight = mesh_;
    const CurveReport report = curve_boundary(mesh_, isosurface_, {limit}, {});
    EXPECT_GE(smallest_ratio(), limit);
    EXPECT_EQ(report.moved + report.unsuitable + report.unseen, report.nodes);
    EXPECT_EQ(report.unsuitable > 0, limit > 0.9);
    mesh_ = std::move(straight);
  }
}

TEST_F(Curved, ADeckKeepsTheOrderOfTheNodes) {
  curve_boundary(mesh_, isosurface_, {}, {});
  const test::TemporaryFolder folder;
  write_abaqus(mesh_, folder.path() / "ball.inp");
  const TetMesh back = read_abaqus(folder.path() / "ball.inp").mesh;
  EXPECT_EQ(back.midside, mesh_.midside);
  WorstElements worst;
  EXPECT_NEAR(measure_volume(back, {}, worst).jacobian_ratio->min, smallest_ratio(), 1e-6);
}

TEST_F(Curved, WithoutAnIsosurfaceBeforeThemNodesStay) {
  // The isosurface of another place.
  Isosurface elsewhere = isosurface_;
  elsewhere.frame.origin = elsewhere.frame.origin + Vec3{200, 0, 0};
  for (Vec3& p : elsewhere.surface.points) p = p + Vec3{200, 0, 0};
  const TetMesh straight = mesh_;
  const CurveReport report = curve_boundary(mesh_, elsewhere, {}, {});
  EXPECT_EQ(report.unseen, report.nodes);
  EXPECT_EQ(mesh_.points, straight.points);
}

}  // namespace
}  // namespace periost
