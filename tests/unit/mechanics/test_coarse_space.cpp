#include "pipeline/mechanics/coarse_space.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "pipeline/mechanics/solver.h"
#include "tests/support/tet_meshes.h"

namespace periost {
namespace {

// A long bar, held at its lower end and pulled sideways at the other.
struct Cantilever {
  TetMesh mesh = test::box_mesh({.cells = {3, 3, 40}, .shake = 0.25, .order = 2});
  Stiffness stiffness = assemble_stiffness(mesh, Material{}, {});
  LoadCase load_case;

  Cantilever() {
    for (Index p = 0; p < mesh.points.size(); ++p) {
      for (int axis = 0; axis < 3 && mesh.points[p].z < 107.01; ++axis) {
        load_case.supports.push_back({p, axis, 0});
      }
      if (mesh.points[p].z > 146.99) load_case.loads.push_back({p, {1, 0, 0}});
    }
  }
};

TEST(CoarseSpace, LumpsHangTogetherAndCoverTheBody) {
  const Cantilever body;
  const std::vector<Index> lump = lumps_of(body.stiffness, 40);
  std::map<Index, std::size_t> size;
  for (const Index l : lump) ++size[l];
  EXPECT_FALSE(size.contains(kNoIndex));
  EXPECT_GT(size.size(), lump.size() / 80);
  for (const auto& [number, members] : size) EXPECT_GE(3 * members, 40U) << number;
  // Every node but a lump's first met has a neighbour of its lump.
  for (std::size_t node = 0; node < lump.size(); ++node) {
    const auto begin =
        body.stiffness.column.begin() + static_cast<std::ptrdiff_t>(body.stiffness.first[node]);
    const auto end =
        body.stiffness.column.begin() + static_cast<std::ptrdiff_t>(body.stiffness.first[node + 1]);
    EXPECT_TRUE(
        std::any_of(begin, end, [&](Index other) { return other != node && lump[other] == lump[node]; }));
  }
}

TEST(CoarseSpace, GivesTheSameSolutionInAFractionOfTheIterations) {
  const Cantilever body;
  const Solution plain = solve_iteratively(body.stiffness, body.load_case, {}, {});
  const Solution coarse = solve_iteratively(body.stiffness, body.load_case, {.points = body.mesh.points}, {});
  EXPECT_TRUE(plain.has_converged && coarse.has_converged);
  EXPECT_LT(5 * coarse.iterations, plain.iterations);
  EXPECT_NEAR(coarse.energy / plain.energy, 1, 1e-9);
  double largest = 0, error = 0;
  for (std::size_t p = 0; p < body.mesh.points.size(); ++p) {
    largest = std::max(largest, norm(plain.displacement[p]));
    error = std::max(error, norm(plain.displacement[p] - coarse.displacement[p]));
  }
  EXPECT_LE(error, 1e-7 * largest);
}

TEST(CoarseSpace, HasTheSameBitsForAnyNumberOfThreads) {
  const Cantilever body;
  Context context;
  const IterativeOptions options{.points = body.mesh.points};
  const Solution one = solve_iteratively(body.stiffness, body.load_case, options, context);
  context.threads = 3;
  const Solution many = solve_iteratively(body.stiffness, body.load_case, options, context);
  EXPECT_EQ(one.iterations, many.iterations);
  EXPECT_EQ(one.energy, many.energy);
}

}  // namespace
}  // namespace periost
