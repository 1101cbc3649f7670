#include "stages/verify/hints.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace periost {
namespace {

// A nearly flat tetrahedron at `at` whose longest edge is `length`.
TetMesh flat_tet(Vec3 at, double length) {
  TetMesh mesh;
  mesh.points = {at, at + Vec3{length, 0, 0}, at + Vec3{length / 2, length / 2, 0},
                 at + Vec3{length / 2, length / 4, length / 50}};
  mesh.tets = {{0, 1, 2, 3}};
  return mesh;
}

QualityReport failing(const char* metric, const char* op, double limit, double value) {
  QualityReport report;
  report.verdict = Verdict::kFail;
  report.isosurface.emplace().voxel_mm = 1;
  report.gates = {{metric, op, limit, {}, value, Verdict::kFail, {}}};
  return report;
}

struct VerifyHints : testing::Test {
  TetMesh mesh = flat_tet({10, -20, 30}, 8);
  SimplexMesh model;
  VerifyInputs inputs{nullptr, &model, nullptr, &mesh, nullptr, nullptr};
  QualityReport slivers = failing("volume.min_dihedral_deg.min", ">=", 25, 3);
  QualityReport far = failing("surface.distance.hausdorff", "<=", 1, 1.25);
  VerifyHints() { model.report.requested_distance_mm = 1.5; }
};

TEST_F(VerifyHints, ABadTetrahedronAtTheSurfaceAsksForShorterEdgesAroundIt) {
  const Hints hints = make_hints(slivers, inputs);
  ASSERT_EQ(hints.hints.size(), 1u);
  const Hint& hint = hints.hints[0];
  EXPECT_EQ(hint.stage, "decimate");
  EXPECT_EQ(hint.parameter, "refine");
  EXPECT_EQ(hint.metric, "volume.min_dihedral_deg.min");
  EXPECT_EQ(hint.value, 3);
  EXPECT_EQ(hint.limit, 25);
  EXPECT_EQ(hint.round, 1u);
  ASSERT_EQ(hint.balls.size(), 1u);
  EXPECT_NEAR(distance(hint.balls[0].centre_mm, {14, -18.5, 30.04}), 0, 1e-12);
  EXPECT_DOUBLE_EQ(hint.balls[0].radius_mm, 12);
  EXPECT_DOUBLE_EQ(hint.balls[0].size_mm, 5.6);
  ASSERT_EQ(hints.rounds.size(), 1u);
  EXPECT_EQ(hints.rounds[0].verdict, Verdict::kFail);
  ASSERT_EQ(hints.rounds[0].changed.size(), 1u);
  EXPECT_EQ(hints.rounds[0].changed[0].key, "decimate.refine");
  EXPECT_NE(hints.rounds[0].reason.find("volume.min_dihedral_deg.min is 3"), std::string::npos);
}

TEST_F(VerifyHints, TheSamePlaceFailingAgainIsSharpenedDownToHalfAVoxel) {
  Hints hints = make_hints(slivers, inputs);
  std::vector<double> sizes;
  for (int round = 2; round < 12; ++round) {
    inputs.hints = &hints;
    Hints next = make_hints(slivers, inputs);
    ASSERT_EQ(next.rounds.size(), static_cast<std::size_t>(round));
    EXPECT_TRUE(std::equal(hints.hints.begin(), hints.hints.end(), next.hints.begin()));  // only added to
    if (next.hints.size() == hints.hints.size()) break;
    sizes.push_back(next.hints.back().balls.at(0).size_mm);
    hints = next;
  }
  EXPECT_LT(sizes.at(0), 4);
  EXPECT_TRUE(std::is_sorted(sizes.rbegin(), sizes.rend()));
  EXPECT_DOUBLE_EQ(sizes.back(), 0.5);
  EXPECT_LT(sizes.size(), 10u);  // it comes to an end
}

TEST_F(VerifyHints, ADistanceOverItsGateIsMadeSmallerInProportion) {
  Hints hints = make_hints(far, inputs);
  ASSERT_EQ(hints.hints.size(), 1u);
  EXPECT_EQ(hints.hints[0].parameter, "distance");
  EXPECT_DOUBLE_EQ(hints.hints[0].factor, 0.95 / 1.25);
  EXPECT_EQ(hints.rounds[0].changed[0].text, "1.14 voxel");
  inputs.hints = &hints;
  model.report.requested_distance_mm = 1.5 * 0.76;  // what decimate was asked in round 2
  EXPECT_DOUBLE_EQ(configured_distance_mm(model, &hints), 1.5);
  const Hints second = make_hints(far, inputs);
  ASSERT_EQ(second.hints.size(), 2u);
  EXPECT_DOUBLE_EQ(second.hints[1].factor, 0.76 * 0.76);
  EXPECT_DOUBLE_EQ(factor_on(&second, "distance"), 0.76 * 0.76);
}

TEST_F(VerifyHints, TheStrongestOfSeveralWishesForTheDistanceCounts) {
  far.gates.push_back({"surface.volume_change", "<=", 0.03, {}, 0.1, Verdict::kFail, {}});
  far.gates.push_back(
      {"surface.distance.surface_to_isosurface.p99", "<=", 0.6, {}, 0.61, Verdict::kFail, {}});
  const Hints hints = make_hints(far, inputs);
  EXPECT_DOUBLE_EQ(factor_on(&hints, "distance"), 0.7);
  EXPECT_EQ(hints.hints.size(), 2u);
}

TEST_F(VerifyHints, WithoutADecimatedModelTheMesherIsAsked) {
  inputs.simplex_mesh = nullptr;
  const Hints hints = make_hints(slivers, inputs);
  ASSERT_EQ(hints.hints.size(), 1u);
  EXPECT_EQ(hints.hints[0].stage, "tetgen");
  EXPECT_EQ(hints.hints[0].parameter, "sizes");
  EXPECT_TRUE(make_hints(far, inputs).hints.empty());
}

TEST_F(VerifyHints, WhatNoParameterMendsGivesNone) {
  EXPECT_TRUE(make_hints(failing("surface.manifold", "==", 1, 0), inputs).hints.empty());
  EXPECT_TRUE(make_hints(failing("volume.tets", "<=", 10, 20), inputs).hints.empty());
  EXPECT_TRUE(make_hints(failing("mechanics.reference.order", "==", 2, 1), inputs).hints.empty());
  EXPECT_FALSE(make_hints(failing("mechanics.reference.energy", "<=", 0.02, 0.03), inputs).hints.empty());
  EXPECT_TRUE(make_hints(failing("volume.min_dihedral_deg.p50", ">=", 60, 50), inputs).hints.empty());
  QualityReport warned = slivers;
  warned.gates[0].status = Verdict::kWarn;
  EXPECT_TRUE(make_hints(warned, inputs).hints.empty());
}

}  // namespace
}  // namespace periost
