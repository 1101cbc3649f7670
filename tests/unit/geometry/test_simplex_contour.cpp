#include "pipeline/geometry/simplex_contour.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pipeline/geometry/isosurface_cut.h"
#include "pipeline/geometry/simplex_dual.h"
#include "pipeline/geometry/topology.h"
#include "stages/marching_cubes/marching_cubes.h"
#include "tests/support/surfaces.h"

namespace periost {
namespace {

// A branching thing in an oblique grid, cut off by the image border on several sides where `open`.
Isosurface branches(bool open) {
  const double c = std::cos(0.4), s = std::sin(0.4);
  Image image{{{22, 24, 20}, {0.7, 0.8, 1.9}, {-31, 12, 55}, {{Vec3{c, 0, s}, {0, 1, 0}, {-s, 0, c}}}}, {}};
  for (std::int32_t k = 0; k < 20; ++k) {
    for (std::int32_t j = 0; j < 24; ++j) {
      for (std::int32_t i = 0; i < 22; ++i) {
        const double stem = 5.3 - std::hypot(i - 1.2, j - 11.7);
        const double arm = 3.4 - std::hypot(j - 11.2, k - 9.6);
        image.values.push_back(static_cast<float>(std::max(stem, arm)));
      }
    }
  }
  return marching_cubes(image, {.lower = 0}, {.open = open}, Context());
}

bool same(const SimplexMesh& a, const SimplexMesh& b) {
  return a.position == b.position && a.neighbour == b.neighbour && a.face == b.face &&
         a.first_vertex == b.first_vertex && a.valence == b.valence && a.dual_position == b.dual_position;
}

TEST(SimplexContour, ClosingMakesAClosedMeshAndOpeningUndoesIt) {
  const Isosurface isosurface = branches(true);
  const SimplexMesh original = dual_simplex_mesh(isosurface.surface);
  SimplexMesh mesh = original;
  Contours contours = close_contours(mesh, isosurface.frame);
  ASSERT_FALSE(contours.empty());
  EXPECT_EQ(check_simplex_mesh(mesh), "");
  for (const auto& row : mesh.neighbour) {
    for (const SimplexVertex v : row) EXPECT_NE(v, kNoVertex);
  }
  std::size_t holes = 0;
  for (std::uint32_t f = 0; f < mesh.valence.size(); ++f)
    holes += contours.is_over_hole(SimplexFace{f}) ? 1u : 0u;
  EXPECT_EQ(euler_number(mesh), euler_number(original) + static_cast<std::int64_t>(holes));
  for (std::size_t v = original.face.size(); v < mesh.face.size(); ++v) {
    // Every contour vertex lies on its plane of the image border.
    const std::uint8_t side = contours.side[v];
    ASSERT_LT(side, kFixedContour);
    const std::size_t axis = side / 2;
    const double plane = side % 2 == 0 ? 0 : isosurface.frame.dims[axis] - 1;
    EXPECT_NEAR(isosurface.frame.to_index(mesh.position[v])[axis], plane, 1e-9);
    EXPECT_TRUE(contours.is_over_hole(mesh.face[v][kHoleSlot]));
    const SimplexVertex next = mesh.neighbour[v][0];
    EXPECT_EQ(mesh.neighbour[index_of(next)][1], SimplexVertex{static_cast<std::uint32_t>(v)});
    const ContourEdge edge = contour_edge_of(mesh, contours, mesh.face[v][1]);
    EXPECT_EQ(index_of(edge.second), v);
    EXPECT_EQ(next_around(mesh, edge.first, mesh.face[v][1]), edge.second);
  }
  open_contours(mesh, contours);
  EXPECT_EQ(check_simplex_mesh(mesh), "");
  compact(mesh, contours);
  EXPECT_TRUE(same(mesh, original));
}

TEST(SimplexContour, AClosedMeshHasNone) {
  SimplexMesh mesh = dual_simplex_mesh(branches(false).surface);
  const SimplexMesh original = mesh;
  EXPECT_TRUE(close_contours(mesh, branches(false).frame).empty());
  EXPECT_TRUE(same(mesh, original));
}

TEST(SimplexContour, WithoutAnImageContoursAreFixed) {
  SurfaceMesh sphere = test::sphere_surface({1, 2, 3}, 5, 2);
  sphere.triangles.resize(100);
  SimplexMesh mesh = dual_simplex_mesh(sphere);
  const std::size_t inner = mesh.face.size();
  const Contours contours = close_contours(mesh, GridFrame());
  for (std::size_t v = inner; v < mesh.face.size(); ++v) EXPECT_EQ(contours.side[v], kFixedContour);
  EXPECT_EQ(contour_edge_of(mesh, contours, mesh.face[0][0]).exists(),
            contours.is_on_contour(mesh.neighbour[0][1]) || contours.is_on_contour(mesh.neighbour[0][2]));
}

class SimplexSewing : public testing::TestWithParam<bool> {};

TEST_P(SimplexSewing, PartsOfACutGiveTheWholeAgain) {
  const Isosurface isosurface = branches(GetParam());
  const SimplexMesh original = dual_simplex_mesh(isosurface.surface);
  for (const CutPlanes& planes : {CutPlanes{0, {4, 9, 15}}, CutPlanes{1, {8, 12}}, CutPlanes{2, {10}}}) {
    std::vector<ContouredMesh> parts;
    std::vector<Vec3> positions;
    for (std::size_t i = 0; i <= planes.at.size(); ++i) {
      ContouredMesh part;
      part.mesh = dual_simplex_mesh(cut_part(isosurface, planes, i).surface);
      positions.insert(positions.end(), part.mesh.position.begin(), part.mesh.position.end());
      part.contours = close_contours(part.mesh, isosurface.frame);
      parts.push_back(std::move(part));
    }
    SewnMesh sewn = sew(parts);
    SimplexMesh& mesh = sewn.whole.mesh;
    EXPECT_EQ(check_simplex_mesh(mesh), "");
    EXPECT_EQ(sewn.whole.contours.empty(), !GetParam());
    EXPECT_FALSE(sewn.seam.empty());
    for (const SimplexVertex v : sewn.seam) EXPECT_FALSE(sewn.whole.contours.is_on_contour(v));
    open_contours(mesh, sewn.whole.contours);
    compact(mesh);
    EXPECT_EQ(check_simplex_mesh(mesh), "");
    EXPECT_EQ(mesh.position, positions) << "inner vertices keep their order";
    EXPECT_EQ(euler_number(mesh), euler_number(original));
    EXPECT_EQ(components_of(mesh).count, components_of(original).count);
    EXPECT_EQ(mesh.valence.size(), original.valence.size());
    const SurfaceMesh surface = dual_triangulation(mesh);
    EXPECT_NEAR(surface_area(surface), surface_area(isosurface.surface), 1e-9 * surface_area(surface));
    EXPECT_EQ(examine_topology(surface).is_closed(), !GetParam());
  }
}

INSTANTIATE_TEST_SUITE_P(ClosedAndOpen, SimplexSewing, testing::Bool());

}  // namespace
}  // namespace periost
