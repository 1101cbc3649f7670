#include "pipeline/mechanics/stretch.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pipeline/geometry/tet_faces.h"
#include "tests/support/tet_meshes.h"

namespace periost {
namespace {

constexpr Material kStretchedBone{17000, 0.3};

// A bar of 60 x 6 x 5 mm along y, far from the origin.
TetMesh bar(std::array<Index, 3> cells, double shake = 0, double width = 6, double thickness = 5) {
  return test::box_mesh(
      {.cell = {width / cells[0], 60.0 / cells[1], thickness / cells[2]}, .cells = cells, .shake = shake});
}

Stretch stretch_of(const TetMesh& mesh, const Material& material = kStretchedBone, int order = 2) {
  return stretch(mesh, stretch_frame(mesh), material, order, {}).value();
}

// The bar as an arch 9 mm high, which bends when it is stretched.
TetMesh arch(std::array<Index, 3> cells) {
  TetMesh mesh = bar(cells);
  for (Vec3& p : mesh.points) p.x += 0.01 * (p.y - 82) * (p.y - 82);
  return mesh;
}

void append(TetMesh& mesh, const TetMesh& other) {
  const auto first = static_cast<Index>(mesh.points.size());
  mesh.points.insert(mesh.points.end(), other.points.begin(), other.points.end());
  for (Tetrahedron tet : other.tets) {
    for (Index& corner : tet) corner += first;
    mesh.tets.push_back(tet);
  }
}

TEST(Stretch, FrameIsTheLongestSide) {
  const StretchFrame frame = stretch_frame(bar({3, 20, 2}));
  EXPECT_EQ(frame.axis, 1U);
  EXPECT_DOUBLE_EQ(frame.low, 52);
  EXPECT_DOUBLE_EQ(frame.high, 112);
}

// Without lateral strain the bar is one-dimensional: E A u' is constant between the planes, and in the bed
// u'' = 16 s u / t^2, an Airy function whose u / u' at the plane is 0.544 t (2 x 0.544 x 0.1 of the length).
TEST(Stretch, StiffnessOfABarIsTheOneOfItsLengthAndSection) {
  const Stretch result = stretch_of(bar({2, 40, 2}), {17000, 0});
  const double length = 60 * (0.8 + 2 * 0.0544);
  EXPECT_NEAR(result.stiffness * length / (17000 * 30), 1, 0.005);
  const double strain = 0.06 / length;
  EXPECT_NEAR(result.p95_von_mises / (17000 * strain), 1, 0.005);
  EXPECT_LT(result.imbalance, 1e-6);
  EXPECT_TRUE(result.has_converged);
  // The body holds most of the energy, the beds the rest.
  const double work = 0.5 * result.stiffness * 0.06 * 0.06;
  EXPECT_LT(result.energy, work);
  EXPECT_GT(result.energy, 0.9 * work);
}

TEST(Stretch, DoesNotDependOnWhereTheNodesLie) {
  const Stretch fine = stretch_of(bar({6, 60, 5}));
  for (const TetMesh& mesh : {bar({2, 13, 2}), bar({3, 17, 2}, 0.25), bar({2, 23, 3}, 0.25)}) {
    const Stretch coarse = stretch(mesh, stretch_frame(mesh), kStretchedBone, 2, {}).value();
    EXPECT_NEAR(coarse.stiffness / fine.stiffness, 1, 0.004);
    EXPECT_NEAR(coarse.energy / fine.energy, 1, 0.004);
    EXPECT_NEAR(coarse.p95_von_mises / fine.p95_von_mises, 1, 0.01);
  }
}

TEST(Stretch, SeesAThinnerBody) {
  const Stretch whole = stretch_of(bar({3, 30, 2})), thin = stretch_of(bar({3, 30, 2}, 0, 5.7));
  EXPECT_NEAR(thin.stiffness / whole.stiffness, 0.95, 0.002);
  EXPECT_NEAR(thin.energy / whole.energy, 0.95, 0.002);
}

TEST(Stretch, RaisesAMeshOfFirstOrder) {
  const TetMesh first = bar({2, 12, 2});
  TetMesh second = first;
  add_midside_nodes(second);
  const Stretch a = stretch_of(first), b = stretch_of(second);
  EXPECT_EQ(a.nodes, b.nodes);
  EXPECT_EQ(a.nodes, second.points.size());
  EXPECT_DOUBLE_EQ(a.stiffness, b.stiffness);
}

TEST(Stretch, LowersAMeshOfSecondOrder) {
  const TetMesh first = arch({2, 12, 2});
  TetMesh second = first;
  add_midside_nodes(second);
  const Stretch a = stretch_of(first, kStretchedBone, 1), b = stretch_of(second, kStretchedBone, 1);
  EXPECT_EQ(a.nodes, first.points.size());
  EXPECT_EQ(b.nodes, first.points.size());
  EXPECT_NEAR(a.stiffness, b.stiffness, 1e-4 * a.stiffness);
  EXPECT_NEAR(a.energy, b.energy, 1e-4 * a.energy);
  EXPECT_NEAR(a.p95_von_mises, b.p95_von_mises, 1e-3 * a.p95_von_mises);
}

// Both orders solve the same problem: what parts them goes away as elements get smaller, and until then the
// first is too stiff where the body bends.
TEST(Stretch, FirstOrderIsStifferTheLargerItsElementsAre) {
  const double truth = stretch_of(arch({6, 60, 5})).stiffness;
  const double fine = stretch_of(arch({8, 80, 7}), kStretchedBone, 1).stiffness / truth;
  const double medium = stretch_of(arch({4, 40, 3}), kStretchedBone, 1).stiffness / truth;
  const double coarse = stretch_of(arch({2, 20, 2}), kStretchedBone, 1).stiffness / truth;
  EXPECT_GT(fine, 1);
  EXPECT_LT(fine, 1.1);
  EXPECT_GT(medium, fine + 0.03);
  EXPECT_GT(coarse, medium + 0.1);
}

TEST(Stretch, FirstOrderIsExactWhereStrainIsUniform) {
  const Stretch first = stretch_of(bar({4, 80, 4}), {17000, 0}, 1);
  const Stretch second = stretch_of(bar({4, 80, 4}), {17000, 0}, 2);
  EXPECT_NEAR(first.stiffness / second.stiffness, 1, 0.002);
  EXPECT_NEAR(first.energy / second.energy, 1, 0.003);
  EXPECT_NEAR(first.p95_von_mises / second.p95_von_mises, 1, 0.003);
  EXPECT_LT(first.imbalance, 1e-5);
}

TEST(Stretch, FirstOrderTakesLessMemory) {
  const TetMesh mesh = bar({2, 12, 2});
  EXPECT_LT(5 * stretch_bytes(mesh, 1), stretch_bytes(mesh, 2));
}

TEST(Stretch, OnlyBodiesThatSpanTheFrameTakePart) {
  TetMesh mesh = bar({2, 12, 2});
  const Stretch alone = stretch_of(mesh);
  append(mesh, test::box_mesh({.low = {0, 60, 107}, .cells = {2, 2, 2}}));
  const Stretch result = stretch_of(mesh);
  EXPECT_EQ(result.bodies, 1U);
  EXPECT_EQ(result.left_out, 1U);
  EXPECT_EQ(result.nodes, alone.nodes);
  EXPECT_NEAR(result.stiffness, alone.stiffness, 1e-6 * alone.stiffness);
  StretchFrame longer = stretch_frame(mesh);
  longer.high += 30;
  EXPECT_FALSE(stretch(mesh, longer, kStretchedBone, 2, {}).has_value());
}

TEST(Stretch, HasTheSameBitsForAnyNumberOfThreads) {
  const TetMesh mesh = bar({3, 30, 3}, 0.2);
  Context context;
  const Stretch one = stretch(mesh, stretch_frame(mesh), kStretchedBone, 2, context).value();
  context.threads = 3;
  const Stretch many = stretch(mesh, stretch_frame(mesh), kStretchedBone, 2, context).value();
  EXPECT_EQ(one.stiffness, many.stiffness);
  EXPECT_EQ(one.energy, many.energy);
  EXPECT_EQ(one.p95_von_mises, many.p95_von_mises);
  EXPECT_EQ(one.iterations, many.iterations);
}

}  // namespace
}  // namespace periost
