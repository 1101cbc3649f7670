#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/base/error.h"
#include "pipeline/geometry/simplex_dual.h"
#include "pipeline/geometry/simplex_walk.h"
#include "tests/support/surfaces.h"

namespace periost {
namespace {

using test::box_surface;
using test::joined;
using test::sphere_surface;
using test::tetrahedron_surface;
using test::torus_surface;

// A square sheet of n x n cells, open all around.
SurfaceMesh sheet_surface(Index n) {
  SurfaceMesh mesh;
  for (Index j = 0; j <= n; ++j) {
    for (Index i = 0; i <= n; ++i) mesh.points.push_back({5.0 + i, -3.0 + 0.7 * j, 0.1 * i * j});
  }
  for (Index j = 0; j < n; ++j) {
    for (Index i = 0; i < n; ++i) {
      const Index a = j * (n + 1) + i, b = a + 1, c = b + n + 1, d = a + n + 1;
      mesh.triangles.push_back({a, b, c});
      mesh.triangles.push_back({a, c, d});
    }
  }
  return mesh;
}

void expect_round_trip(const SurfaceMesh& surface) {
  const SimplexMesh mesh = dual_simplex_mesh(surface);
  EXPECT_EQ(check_simplex_mesh(mesh), "");
  const SurfaceMesh back = dual_triangulation(mesh);
  EXPECT_EQ(back.points, surface.points);
  EXPECT_EQ(back.triangles, surface.triangles);
  EXPECT_EQ(back.point_fields, surface.point_fields);
  EXPECT_EQ(back.voxel_mm, surface.voxel_mm);
  const SimplexMesh again = dual_simplex_mesh(back);
  EXPECT_EQ(again.neighbour, mesh.neighbour);
  EXPECT_EQ(again.face, mesh.face);
  EXPECT_EQ(again.valence, mesh.valence);
  EXPECT_EQ(again.first_vertex, mesh.first_vertex);
}

TEST(SimplexDual, DualOfDualIsTheSameMesh) {
  expect_round_trip(tetrahedron_surface());
  expect_round_trip(box_surface({-1, 2, 3}, {4, 5, 7}));
  expect_round_trip(torus_surface(5, 2, 17, 9));
  SurfaceMesh sphere = sphere_surface({10, -20, 30}, 4, 3);
  sphere.voxel_mm = 1.5;
  sphere.point_fields["cause"].assign(sphere.points.size(), 2.5F);
  expect_round_trip(sphere);
}

TEST(SimplexDual, OpenSurfacesAndSeveralComponentsRoundTrip) {
  expect_round_trip(sheet_surface(1));
  expect_round_trip(sheet_surface(6));
  expect_round_trip(joined(torus_surface(5, 2, 12, 8), sphere_surface({20, 0, 0}, 3, 1)));
}

TEST(SimplexDual, EveryVertexKeepsTheOrderAndOrientationOfItsTriangle) {
  const SurfaceMesh surface = torus_surface(5, 2, 17, 9);
  const SimplexMesh mesh = dual_simplex_mesh(surface);
  for (std::uint32_t i = 0; i < mesh.face.size(); ++i) {
    const SimplexVertex v{i};
    for (int k = 0; k < 3; ++k) {
      EXPECT_EQ(index_of(face_of(mesh, v, k)), surface.triangles[i][static_cast<std::size_t>(k)]);
      const SimplexVertex w = neighbour_of(mesh, v, k);
      EXPECT_EQ(slot_of(mesh, w, face_of(mesh, v, k)), -1) << "the face opposite to the edge is beside it";
      EXPECT_EQ(other_end(mesh, other_end(mesh, {v, k})), (SimplexEdge{v, k}));
    }
  }
}

TEST(SimplexDual, EulerNumberAndComponents) {
  EXPECT_EQ(euler_number(dual_simplex_mesh(torus_surface(5, 2, 12, 8))), 0);
  EXPECT_EQ(euler_number(dual_simplex_mesh(sphere_surface({}, 1, 2))), 2);
  EXPECT_EQ(euler_number(dual_simplex_mesh(sheet_surface(4))), 1);
  const SimplexMesh mesh =
      dual_simplex_mesh(joined(torus_surface(5, 2, 12, 8), sphere_surface({20, 0, 0}, 3, 1)));
  const SimplexComponents components = components_of(mesh);
  EXPECT_EQ(components.count, 2u);
  EXPECT_EQ(components.of_vertex.front(), 0u);
  EXPECT_EQ(components.of_vertex.back(), 1u);
}

TEST(SimplexDual, UnusedPointsAreDropped) {
  SurfaceMesh surface = tetrahedron_surface();
  surface.points.insert(surface.points.begin() + 1, Vec3{99, 99, 99});
  for (Triangle& corners : surface.triangles) {
    for (Index& corner : corners) corner += corner >= 1 ? 1 : 0;
  }
  const SurfaceMesh back = dual_triangulation(dual_simplex_mesh(surface));
  EXPECT_EQ(back.points, tetrahedron_surface().points);
  EXPECT_EQ(back.triangles, tetrahedron_surface().triangles);
}

void expect_refused(const SurfaceMesh& surface, const std::string& what, const std::string& place) {
  try {
    dual_simplex_mesh(surface);
    ADD_FAILURE() << "accepted: " << what;
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kQuality);
    EXPECT_THAT(error.what(), testing::HasSubstr(what));
    EXPECT_THAT(error.what(), testing::HasSubstr(place));
  }
}

TEST(SimplexDual, NonManifoldInputIsRefusedWithThePlace) {
  SurfaceMesh fin = tetrahedron_surface();
  fin.points.push_back({5, 5, 5});
  fin.triangles.push_back({0, 1, 4});
  expect_refused(fin, "more than two triangles", "(1.000, 0.000, 0.000) mm");

  SurfaceMesh turned = tetrahedron_surface();
  std::swap(turned.triangles[0][0], turned.triangles[0][1]);
  expect_refused(turned, "face opposite ways", "mm");

  SurfaceMesh repeated = tetrahedron_surface();
  repeated.triangles[0] = {0, 0, 2};
  expect_refused(repeated, "a corner twice", "(1.000, 1.000, 1.000) mm");

  SurfaceMesh pinched = joined(tetrahedron_surface(), tetrahedron_surface());
  for (std::size_t t = 4; t < 8; ++t) {
    for (Index& corner : pinched.triangles[t]) corner = corner == 4 ? 0 : corner;
  }
  expect_refused(pinched, "touch in one point", "(1.000, 1.000, 1.000) mm");

  SurfaceMesh lying = tetrahedron_surface();
  lying.triangles[2][1] = 17;
  expect_refused(lying, "names point 17", "4 points");
}

TEST(SimplexDual, CheckFindsDamage) {
  const SimplexMesh sound = dual_simplex_mesh(sphere_surface({}, 1, 1));
  ASSERT_EQ(check_simplex_mesh(sound), "");
  SimplexMesh broken = sound;
  std::swap(broken.neighbour[3][0], broken.neighbour[3][1]);
  EXPECT_NE(check_simplex_mesh(broken), "");
  broken = sound;
  ++broken.valence[5];
  EXPECT_NE(check_simplex_mesh(broken), "");
  broken = sound;
  broken.face[7] = {kNoFace, kNoFace, kNoFace};
  EXPECT_NE(check_simplex_mesh(broken), "");
  broken = sound;
  broken.first_vertex[0] = SimplexVertex{static_cast<std::uint32_t>(broken.face.size() - 1)};
  EXPECT_NE(check_simplex_mesh(broken), "");
}

}  // namespace
}  // namespace periost
