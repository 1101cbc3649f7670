#include <gtest/gtest.h>

#include <algorithm>

#include "pipeline/io/simplex_write.h"
#include "pipeline/io/vtk_mesh_read.h"
#include "tests/support/process.h"

namespace periost::test {
namespace {

// The simplex mesh of a tetrahedron is a tetrahedron: vertex v is dual to the triangle opposite to face v.
SimplexMesh tetrahedron() {
  SimplexMesh mesh;
  mesh.position = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  const std::uint32_t triangles[4][3] = {{1, 3, 2}, {0, 2, 3}, {0, 3, 1}, {0, 1, 2}};
  for (const auto& [a, b, c] : triangles) {
    mesh.face.push_back({SimplexFace{a}, SimplexFace{b}, SimplexFace{c}});
    mesh.neighbour.push_back({SimplexVertex{a}, SimplexVertex{b}, SimplexVertex{c}});
  }
  mesh.first_vertex = {SimplexVertex{1}, SimplexVertex{0}, SimplexVertex{0}, SimplexVertex{0}};
  mesh.valence = {3, 3, 3, 3};
  mesh.dual_position.resize(4);
  mesh.face_fields["cause"] = {0, 1, 2, 3};
  return mesh;
}

TEST(SimplexWrite, EveryFaceIsAPolygonThatVtkReads) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "simplex_mesh.vtp";
  write_simplex_vtp(tetrahedron(), path);
  const SurfaceMesh read = read_vtk_surface(path);
  ASSERT_EQ(read.points.size(), 4u);
  ASSERT_EQ(read.triangles.size(), 4u);
  for (Index face = 0; face < 4; ++face) {
    const Triangle& corners = read.triangles[face];
    EXPECT_EQ(std::count(corners.begin(), corners.end(), face), 0)
        << "vertex v is dual to the triangle that misses face v";
  }
}

TEST(SimplexWrite, AFaceAtABorderIsLeftOut) {
  const TemporaryFolder folder;
  SimplexMesh mesh = tetrahedron();
  mesh.neighbour[0][0] = kNoVertex;
  EXPECT_NO_THROW(write_simplex_vtp(mesh, folder.path() / "open.vtp"));
}

}  // namespace
}  // namespace periost::test
