#include <gtest/gtest.h>

#include "pipeline/geometry/tet_faces.h"

namespace periost {
namespace {

// Two tetrahedra on one face, and one apart.
TetMesh three() {
  TetMesh mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.3, 0.3, -1},
                 {5, 0, 0}, {6, 0, 0}, {5, 1, 0}, {5, 0, 1}};
  mesh.tets = {{0, 1, 2, 3}, {0, 2, 1, 4}, {5, 6, 7, 8}};
  return mesh;
}

TEST(TetFaces, NeighboursAndBodies) {
  const TetMesh mesh = three();
  const auto neighbours = tet_neighbours(mesh.tets, mesh.points.size());
  EXPECT_EQ(neighbours[0], (TetNeighbours{kNoIndex, kNoIndex, kNoIndex, 1}));
  EXPECT_EQ(neighbours[1], (TetNeighbours{kNoIndex, kNoIndex, kNoIndex, 0}));
  EXPECT_EQ(boundary_faces(neighbours).size(), 10U);
  EXPECT_EQ(tet_components(neighbours), (std::vector<std::uint32_t>{0, 0, 1}));
}

TEST(TetFaces, FacesPointOutward) {
  const TetMesh mesh = three();
  for (const Tetrahedron& tet : mesh.tets) {
    for (int k = 0; k < 4; ++k) {
      const auto [a, b, c] = face_of(tet, k);
      const Vec3 opposite = mesh.points[tet[static_cast<std::size_t>(k)]];
      EXPECT_LT(six_volumes(mesh.points[a], mesh.points[b], mesh.points[c], opposite), 0);
    }
  }
}

TEST(TetFaces, MidsideNodesAreSharedAndMovedBackWhenAskedAgain) {
  TetMesh mesh = three();
  mesh.point_fields["depth"] = {0, 2, 0, 0, 0, 0, 0, 0, 0};
  add_midside_nodes(mesh);
  EXPECT_EQ(mesh.points.size(), 9U + 9U + 6U);
  EXPECT_EQ(mesh.midside[0][0], mesh.midside[1][2]) << "edge 0-1 of both";
  EXPECT_EQ(mesh.points[mesh.midside[0][4]], (Vec3{0.5, 0, 0.5})) << "edge 1-3";
  EXPECT_EQ(mesh.point_fields["depth"][mesh.midside[0][0]], 1.0F);
  mesh.points[3].z = 2;
  add_midside_nodes(mesh);
  EXPECT_EQ(mesh.points[mesh.midside[0][4]], (Vec3{0.5, 0, 1}));
  EXPECT_EQ(mesh.points.size(), 24U);
}

}  // namespace
}  // namespace periost
