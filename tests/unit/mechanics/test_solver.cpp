#include "pipeline/mechanics/solver.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pipeline/base/error.h"
#include "tests/support/tet_meshes.h"

namespace periost {
namespace {

constexpr Material kBone{17000, 0.3};

bool lies_at(double value, double place) {
  return std::abs(value - place) < 1e-9;
}

TEST(Stiffness, IsSymmetricToTheLastBit) {
  for (const TetMesh& mesh :
       {test::badly_shaped_box(1), test::badly_shaped_box(2), test::badly_shaped_box(2, 0.02)}) {
    const Stiffness k = assemble_stiffness(mesh, kBone, {});
    for (std::size_t row = 0; row < k.nodes(); ++row) {
      for (std::size_t b = k.first[row]; b < k.first[row + 1]; ++b) {
        const Block& other = k.blocks[k.find(k.column[b], static_cast<Index>(row))];
        for (std::size_t i = 0; i < 9; ++i) ASSERT_EQ(k.blocks[b][i], other[3 * (i % 3) + i / 3]);
      }
    }
  }
}

TEST(Stiffness, HasTheSameBitsForAnyNumberOfThreads) {
  const TetMesh mesh = test::badly_shaped_box(2, 0.02);
  Context context;
  const Stiffness one = assemble_stiffness(mesh, kBone, context);
  for (const int threads : {2, 4}) {
    context.threads = threads;
    const Stiffness many = assemble_stiffness(mesh, kBone, context);
    EXPECT_EQ(one.first, many.first);
    EXPECT_EQ(one.column, many.column);
    EXPECT_EQ(one.blocks, many.blocks);
  }
}

// A bar of 3 x 2 mm, 12 mm long, pulled by a thousandth: the answer is uniform, whatever the mesh.
TEST(Solver, ABarInTension) {
  for (const int order : {1, 2}) {
    const Vec3 low{-31, 52, 107};
    const TetMesh mesh = test::box_mesh({.low = low, .cells = {12, 3, 2}, .shake = 0.3, .order = order});
    LoadCase bar;
    for (Index n = 0; n < mesh.points.size(); ++n) {
      const Vec3 at = mesh.points[n] - low;
      if (lies_at(at.x, 0)) bar.supports.push_back({n, 0, 0});
      if (lies_at(at.x, 12)) bar.supports.push_back({n, 0, 0.012});
      if (lies_at(at.y, 0)) bar.supports.push_back({n, 1, 0});
      if (lies_at(at.z, 0)) bar.supports.push_back({n, 2, 0});
    }
    const Stiffness stiffness = assemble_stiffness(mesh, kBone, {});
    const Solution direct = solve_directly(stiffness, bar, {});
    const Solution iterative = solve_iteratively(stiffness, bar, {.tolerance = 1e-12}, {});
    EXPECT_TRUE(iterative.has_converged);
    EXPECT_GT(iterative.iterations, 10U);
    for (const Solution& solution : {direct, iterative}) {
      double pull = 0;
      for (Index n = 0; n < mesh.points.size(); ++n) {
        const Vec3 at = mesh.points[n] - low;
        EXPECT_NEAR(distance(solution.displacement[n], {0.001 * at.x, -0.0003 * at.y, -0.0003 * at.z}), 0,
                    1e-11);
        if (lies_at(at.x, 12)) pull += solution.reaction[n].x;
      }
      EXPECT_NEAR(pull, 17000 * 0.001 * 6, 1e-8);                   // E strain area
      EXPECT_NEAR(solution.energy, 0.5 * 17000 * 1e-6 * 72, 1e-9);  // E strain^2 / 2 a volume
    }
  }
}

// A beam of 2 x 2 mm, 20 mm long, bent by a load at its end: F L^3 / 3 E I + F L / (5/6 G A), to 2 %.
TEST(Solver, ACantileverOfSecondOrder) {
  const Vec3 low{-31, 52, 107};
  const TetMesh mesh = test::box_mesh({.low = low, .cells = {20, 2, 2}, .order = 2});
  LoadCase beam;
  std::vector<Index> end;
  for (Index n = 0; n < mesh.points.size(); ++n) {
    const Vec3 at = mesh.points[n] - low;
    for (int axis = 0; axis < 3 && lies_at(at.x, 0); ++axis) beam.supports.push_back({n, axis, 0});
    if (lies_at(at.x, 20)) end.push_back(n);
  }
  const double force = 10;
  for (const Index n : end) beam.loads.push_back({n, {0, 0, force / static_cast<double>(end.size())}});
  const Stiffness stiffness = assemble_stiffness(mesh, kBone, {});
  const Solution solution = solve_directly(stiffness, beam, {});
  const double bending = force * 20 * 20 * 20 / (3 * 17000 * (16 / 12.0));
  const double shear = force * 20 / (5.0 / 6 * 17000 / 2.6 * 4);
  double sag = 0;
  Vec3 ground;
  for (const Index n : end) sag += solution.displacement[n].z / static_cast<double>(end.size());
  for (const Vec3& reaction : solution.reaction) ground += reaction;
  EXPECT_NEAR(sag / (bending + shear), 1, 0.02);
  EXPECT_NEAR(ground.z, -force, 1e-9);
  EXPECT_NEAR(ground.x, 0, 1e-9);
}

TEST(Solver, BothAgreeAndThreadsDoNotMatter) {
  const TetMesh mesh = test::badly_shaped_box(2, 0.02);
  const Stiffness stiffness = assemble_stiffness(mesh, kBone, {});
  LoadCase some;
  for (Index n = 0; n < 12; ++n) some.supports.push_back({n, static_cast<int>(n % 3), 0.001 * n});
  some.loads = {{40, {1, 2, 3}}, {41, {-4, 0, 2}}};
  const Solution direct = solve_directly(stiffness, some, {});
  Context context;
  const Solution one = solve_iteratively(stiffness, some, {.tolerance = 1e-13}, context);
  double largest = 0, error = 0;
  for (std::size_t n = 0; n < stiffness.nodes(); ++n) {
    largest = std::max(largest, norm(direct.displacement[n]));
    error = std::max(error, distance(direct.displacement[n], one.displacement[n]));
  }
  EXPECT_LT(error, 1e-9 * largest);
  for (const int threads : {2, 4}) {
    context.threads = threads;
    const Solution many = solve_iteratively(stiffness, some, {.tolerance = 1e-13}, context);
    EXPECT_EQ(one.displacement, many.displacement);
    EXPECT_EQ(one.reaction, many.reaction);
    EXPECT_EQ(one.iterations, many.iterations);
  }
}

TEST(Solver, AFreeBodyIsRefused) {
  const Stiffness stiffness = assemble_stiffness(test::badly_shaped_box(1), kBone, {});
  LoadCase pinned;  // it can still turn
  for (int axis = 0; axis < 3; ++axis) pinned.supports.push_back({0, axis, 0});
  pinned.loads = {{40, {1, 2, 3}}};
  try {
    solve_directly(stiffness, pinned, {});
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), "mechanics.singular");
  }
  EXPECT_FALSE(
      solve_iteratively(stiffness, pinned, {.tolerance = 1e-12, .max_iterations = 5}, {}).has_converged);
}

TEST(Solver, PointsWithoutTetrahedraStayOutOfIt) {
  TetMesh mesh = test::badly_shaped_box(1);
  mesh.points.insert(mesh.points.begin(), Vec3{0, 0, 0});
  for (Tetrahedron& tet : mesh.tets) {
    for (Index& corner : tet) ++corner;
  }
  const Stiffness stiffness = assemble_stiffness(mesh, kBone, {});
  EXPECT_FALSE(stiffness.is_used(0));
  EXPECT_EQ(count_eigenvalues_below(stiffness, 1e-10), 6U);
  LoadCase held;
  for (Index n = 0; n < 20; ++n) {
    for (int axis = 0; axis < 3; ++axis) held.supports.push_back({n, axis, 0.5});
  }
  const Solution solution = solve_directly(stiffness, held, {});
  EXPECT_EQ(solution.displacement[0], Vec3{});
  EXPECT_NEAR(distance(solution.displacement.back(), {0.5, 0.5, 0.5}), 0, 1e-12);
}

TEST(Solver, AFreeBodyHasSixMotionsWithoutEnergy) {
  for (const TetMesh& mesh :
       {test::badly_shaped_box(1), test::badly_shaped_box(2), test::badly_shaped_box(2, 0.02)}) {
    EXPECT_EQ(count_eigenvalues_below(assemble_stiffness(mesh, kBone, {}), 1e-10), 6U);
  }
}

}  // namespace
}  // namespace periost
