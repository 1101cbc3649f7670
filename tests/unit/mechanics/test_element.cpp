#include "pipeline/mechanics/element.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pipeline/geometry/tet_quality.h"
#include "pipeline/mechanics/stiffness.h"
#include "tests/support/tet_meshes.h"

namespace periost {
namespace {

TetMesh one_element(int order, double bend_mm = 0) {
  TetMesh mesh;
  mesh.points = {{10, 20, 30}, {12, 20.5, 30}, {10.2, 21.5, 30.3}, {10.4, 20.1, 31.7}};
  mesh.tets = {{0, 1, 2, 3}};
  if (order == 2) add_midside_nodes(mesh);
  if (bend_mm > 0) test::bend(mesh, bend_mm);
  return mesh;
}

double volume_of(const ElementShape& shape) {
  double sum = 0;
  for (std::size_t p = 0; p < shape.points; ++p) sum += shape.at[p].volume;
  return sum;
}

TEST(Element, PointsByOrderAndShape) {
  EXPECT_EQ(element_shape(one_element(1), 0).points, 1U);
  EXPECT_EQ(element_shape(one_element(2), 0).points, 4U);
  EXPECT_EQ(element_shape(one_element(2, 0.05), 0).points, 14U);
}

TEST(Element, VolumesAddUp) {
  const TetMesh straight = one_element(2);
  const TetCorners corners{straight.points[0], straight.points[1], straight.points[2], straight.points[3]};
  EXPECT_NEAR(volume_of(element_shape(one_element(1), 0)), tet_volume(corners), 1e-14);
  EXPECT_NEAR(volume_of(element_shape(straight, 0)), tet_volume(corners), 1e-14);
}

// A displacement that is a polynomial of the element's order has its derivative at every point.
TEST(Element, GradientsAreThoseOfTheNodesPositions) {
  for (const TetMesh& mesh : {one_element(1), one_element(2), one_element(2, 0.05)}) {
    const ElementShape shape = element_shape(mesh, 0);
    ASSERT_TRUE(is_regular(shape));
    for (std::size_t p = 0; p < shape.points; ++p) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        Vec3 gradient;
        for (std::size_t k = 0; k < shape.nodes; ++k) {
          gradient += (mesh.points[k][axis] - mesh.points[0][axis]) * shape.at[p].gradient[k];
        }
        for (std::size_t b = 0; b < 3; ++b) EXPECT_NEAR(gradient[b], axis == b ? 1 : 0, 1e-13);
      }
    }
  }
}

// The determinant is of degree 3 and the rule of degree 5: the volume is exact. Two edges of the face z = 0
// sag.
TEST(Element, ACurvedElementHasItsExactVolume) {
  TetMesh mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.tets = {{0, 1, 2, 3}};
  add_midside_nodes(mesh);
  const double sag = 0.1;
  mesh.points[mesh.midside[0][0]].z -= sag;  // of the edge along x
  mesh.points[mesh.midside[0][2]].z -= sag;  // of the edge along y
  // Gained below the face: the integral of 4 sag (l0 l1 + l0 l2), each product 1/24.
  EXPECT_NEAR(volume_of(element_shape(mesh, 0)), 1.0 / 6 + 4 * sag * 2 / 24, 1e-14);
}

TEST(Element, AFoldedElementIsNotRegular) {
  TetMesh mesh = one_element(2);
  mesh.points[4] = mesh.points[0] + 3 * (mesh.points[1] - mesh.points[0]);
  EXPECT_FALSE(is_regular(element_shape(mesh, 0)));
  std::swap(mesh.tets[0][0], mesh.tets[0][1]);
  EXPECT_EQ(folded_tets(mesh, {}), (std::vector<std::size_t>{0}));
}

TEST(Element, StressOfSimpleStates) {
  const LameConstants lame = lame_constants({1000, 0.25});
  EXPECT_NEAR(lame.lambda, 400, 1e-10);
  EXPECT_NEAR(lame.mu, 400, 1e-10);
  const TetMesh mesh = one_element(2, 0.05);
  const ElementShape shape = element_shape(mesh, 0);
  std::vector<Vec3> pull, twist;
  for (const Vec3& p : mesh.points) {
    pull.push_back({0.001 * p.x, -0.00025 * p.y, -0.00025 * p.z});
    twist.push_back({0, 0.001 * p.x, 0});
  }
  for (std::size_t p = 0; p < shape.points; ++p) {
    const Stress tension = stress_at(shape.at[p], lame, pull), shear = stress_at(shape.at[p], lame, twist);
    EXPECT_NEAR(tension[0], 1, 1e-11);
    EXPECT_NEAR(von_mises(tension), 1, 1e-11);
    for (std::size_t k = 1; k < 6; ++k) EXPECT_NEAR(tension[k], 0, 1e-11);
    EXPECT_NEAR(shear[3], 0.4, 1e-11);
    EXPECT_NEAR(von_mises(shear), 0.4 * std::sqrt(3.0), 1e-11);
  }
}

}  // namespace
}  // namespace periost
