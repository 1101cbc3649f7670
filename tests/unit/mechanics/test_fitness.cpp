#include "pipeline/mechanics/fitness.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pipeline/geometry/tet_quality.h"
#include "pipeline/mechanics/conditioning.h"
#include "pipeline/mechanics/patch_test.h"
#include "pipeline/mechanics/rigid_modes.h"
#include "pipeline/mechanics/solver.h"
#include "tests/support/tet_meshes.h"

namespace periost {
namespace {

RigidModes modes_of(const TetMesh& mesh) {
  return rigid_modes(mesh, assemble_stiffness(mesh, Material{}, {}), {});
}

double patch_error_of(const TetMesh& mesh) {
  return patch_test(mesh, assemble_stiffness(mesh, Material{}, {}), {}).error;
}

// Two boxes of 2 x 2 x 2 cells; the second stands on the far corner, edge or face of the first, or apart.
TetMesh two_boxes(Vec3 shift, int order) {
  TetMesh mesh = test::box_mesh({.cells = {2, 2, 2}});
  const TetMesh other = test::box_mesh({.low = Vec3{-31, 52, 107} + shift, .cells = {2, 2, 2}});
  std::vector<Index> number;
  const std::size_t own = mesh.points.size();
  for (const Vec3& p : other.points) {
    std::size_t same = 0;
    while (same < own && distance(mesh.points[same], p) > 1e-9) ++same;
    number.push_back(static_cast<Index>(same < own ? same : mesh.points.size()));
    if (same == own) mesh.points.push_back(p);
  }
  for (const Tetrahedron& t : other.tets) {
    mesh.tets.push_back({number[t[0]], number[t[1]], number[t[2]], number[t[3]]});
  }
  if (order == 2) add_midside_nodes(mesh);
  return mesh;
}

TEST(PatchTest, HoldsForBadlyShapedElementsFarFromTheOrigin) {
  for (const TetMesh& mesh :
       {test::badly_shaped_box(1), test::badly_shaped_box(2), test::badly_shaped_box(2, 0.02)}) {
    const PatchTest result = patch_test(mesh, assemble_stiffness(mesh, Material{}, {}), {});
    EXPECT_LE(result.error, 1e-9);
    EXPECT_GT(result.free_nodes, 100U);
  }
}

TEST(PatchTest, FailsWhereNeighboursDoNotFit) {
  TetMesh mesh = test::badly_shaped_box(2);
  const std::vector<bool> is_on_boundary = boundary_nodes(mesh);
  const std::size_t tet = mesh.tets.size() / 2;
  const auto inner = std::find_if(mesh.midside[tet].begin(), mesh.midside[tet].end(),
                                  [&](Index node) { return !is_on_boundary[node]; });
  ASSERT_NE(inner, mesh.midside[tet].end());
  mesh.points.push_back(mesh.points[*inner]);
  *inner = static_cast<Index>(mesh.points.size() - 1);
  EXPECT_GT(patch_error_of(mesh), 1e-3) << "a gap";
  mesh = test::badly_shaped_box(2);
  std::swap(mesh.midside[tet][0], mesh.midside[tet][5]);
  EXPECT_GT(patch_error_of(mesh), 1e-3) << "two mid-side nodes exchanged";
}

TEST(RigidModes, SixForABodyInOnePiece) {
  for (const TetMesh& mesh :
       {test::badly_shaped_box(1), test::badly_shaped_box(2), test::badly_shaped_box(2, 0.02)}) {
    const RigidModes modes = modes_of(mesh);
    EXPECT_EQ(modes.count, 6U);
    EXPECT_LE(modes.error, 1e-12);
  }
}

TEST(RigidModes, PiecesAndHingesAreCounted) {
  for (const int order : {1, 2}) {
    EXPECT_EQ(modes_of(two_boxes({5, 0, 0}, order)).count, 12U) << "apart";
    EXPECT_EQ(modes_of(two_boxes({2, 2, 2}, order)).count, 9U) << "joined at a corner";
    EXPECT_EQ(modes_of(two_boxes({2, 2, 0}, order)).count, 7U) << "hinged at an edge";
    EXPECT_EQ(modes_of(two_boxes({2, 0, 0}, order)).count, 6U) << "joined at a face";
  }
}

TEST(RigidModes, BodiesThatShareNoNodeAreToldFromHinges) {
  EXPECT_EQ(modes_of(two_boxes({5, 0, 0}, 1)).bodies, 2U);
  EXPECT_EQ(modes_of(two_boxes({2, 2, 2}, 1)).bodies, 1U);
  WorstElements worst;
  EXPECT_EQ(measure_fitness(two_boxes({5, 0, 0}, 1), {}, worst)->rigid_modes, 6U) << "each is whole";
  EXPECT_EQ(measure_fitness(two_boxes({2, 2, 0}, 1), {}, worst)->rigid_modes, 7U) << "a hinge";
}

TEST(RigidModes, ConnectivityAloneAgreesWithTheMatrix) {
  for (const Vec3 shift : {Vec3{5, 0, 0}, Vec3{2, 2, 2}, Vec3{2, 2, 0}, Vec3{2, 0, 0}}) {
    const TetMesh mesh = two_boxes(shift, 2);
    EXPECT_EQ(rigid_modes_by_connectivity(mesh).count,
              count_eigenvalues_below(assemble_stiffness(mesh, Material{}, {}), 1e-11));
  }
}

TEST(Conditioning, TheIdealMeshIsIdeal) {
  const TetMesh mesh = ideal_mesh(4, 2.5, 2);
  EXPECT_EQ(mesh.tets.size(), 12U * 16 * 3);
  for (const Tetrahedron& t : mesh.tets) {
    const TetCorners corners{mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]], mesh.points[t[3]]};
    EXPECT_NEAR(tet_volume(corners), 2.5, 1e-12);
    const DihedralRange angles = tet_dihedral_range(corners);
    EXPECT_NEAR(angles.min_deg, 60, 1e-10);
    EXPECT_NEAR(angles.max_deg, 90, 1e-10);
  }
  EXPECT_EQ(modes_of(mesh).count, 6U) << "one body";
}

TEST(Conditioning, AnIdealMeshHasRatiosOfOne) {
  for (const int order : {1, 2}) {
    const TetMesh mesh = ideal_mesh(9, 0.3, order);
    WorstElements worst;
    const auto quality = measure_fitness(mesh, {}, worst);
    ASSERT_TRUE(quality);
    EXPECT_NEAR(quality->condition_ratio, 1, 1e-9);
    EXPECT_NEAR(quality->cg_ratio, 1, 0.05);
  }
}

// The bed takes the size of the body out of the count, and the unit out of everything.
TEST(Conditioning, SizeAndUnitDoNotMatter) {
  std::vector<double> iterations;
  for (const Index cells : {6U, 9U, 14U}) {
    const TetMesh mesh = ideal_mesh(cells, cells * 1e-3, 1);
    Stiffness stiffness = assemble_stiffness(mesh, Material{}, {});
    iterations.push_back(static_cast<double>(iterations_on_bed(mesh, Material{}, stiffness, {})));
  }
  EXPECT_NEAR(iterations[1] / iterations[0], 1, 0.03);
  EXPECT_NEAR(iterations[2] / iterations[1], 1, 0.03);
}

TEST(Conditioning, ASliverRaisesIt) {
  WorstElements worst;
  const auto mild = measure_fitness(test::badly_shaped_box(1, 0, 0), {}, worst);
  TetMesh mesh = test::badly_shaped_box(1, 0, 0);
  const Index inner = 3 + 7 * (2 + 6 * 3);
  mesh.points[inner] += Vec3{0.95, 0, 0};  // nearly onto its neighbour
  const auto bad = measure_fitness(mesh, {}, worst);
  ASSERT_TRUE(mild && bad);
  EXPECT_GT(bad->condition_ratio, 4 * mild->condition_ratio);
  EXPECT_GT(bad->cg_iterations, mild->cg_iterations);
  ASSERT_EQ(worst["mechanics.condition_ratio"].size(), 10U);
  EXPECT_LT(distance(worst["mechanics.condition_ratio"][0].centre_mm, mesh.points[inner]), 1.5);
  EXPECT_EQ(bad->rigid_modes, 6U);
  EXPECT_LE(bad->patch_test_error, 1e-9);
}

TEST(Fitness, HasTheSameBitsForAnyNumberOfThreads) {
  const TetMesh mesh = test::badly_shaped_box(2, 0.02);
  Context context;
  WorstElements worst;
  const auto one = measure_fitness(mesh, context, worst);
  for (const int threads : {2, 4}) {
    context.threads = threads;
    const auto many = measure_fitness(mesh, context, worst);
    ASSERT_TRUE(one && many);
    EXPECT_EQ(one->patch_test_error, many->patch_test_error);
    EXPECT_EQ(one->rigid_mode_error, many->rigid_mode_error);
    EXPECT_EQ(one->condition_ratio, many->condition_ratio);
    EXPECT_EQ(one->cg_iterations, many->cg_iterations);
  }
}

TEST(Fitness, SaysWhyThereIsNoneToMeasure) {
  Context context;
  std::vector<std::string> codes;
  context.sink = [&](const Event& event) { codes.push_back(event.code); };
  WorstElements worst;
  EXPECT_FALSE(measure_fitness({}, context, worst));
  TetMesh mesh = test::badly_shaped_box(1);
  std::swap(mesh.tets[7][0], mesh.tets[7][1]);
  EXPECT_FALSE(measure_fitness(mesh, context, worst));
  context.memory_bytes = 100000;
  EXPECT_FALSE(measure_fitness(test::badly_shaped_box(1), context, worst));
  EXPECT_EQ(codes, (std::vector<std::string>{"mechanics.folded", "mechanics.too_large"}));
}

}  // namespace
}  // namespace periost
