#include "stages/verify/verify.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/mechanics/stretch.h"
#include "tests/support/surfaces.h"
#include "tests/support/tet_meshes.h"

namespace periost {
namespace {

TEST(Verify, NeverThrowsOnAFailedGateAndLogsIt) {
  SurfaceMesh surface = test::sphere_surface({0, 0, 50}, 10, 2);
  surface.triangles.pop_back();
  Context context;
  std::vector<Event> events;
  context.sink = [&](const Event& event) { events.push_back(event); };
  VerifyOptions options;
  options.preset = Preset::kLenient;
  const QualityReport report = verify({nullptr, nullptr, &surface, nullptr}, options, context);
  EXPECT_EQ(report.verdict, Verdict::kFail);
  ASSERT_GE(events.size(), 2u);
  EXPECT_EQ(events[0].code, "quality.fail");
  EXPECT_NE(events[0].text.find("surface.closed is 0, the gate asks for == 1; worst at ("), std::string::npos)
      << events[0].text;
  EXPECT_EQ(events.back().code, "quality.verdict");
}

TEST(Verify, AVolumeWithoutASurfaceHasItsBoundaryMeasured) {
  TetMesh mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.tets = {{0, 1, 2, 3}};
  Context context;
  const QualityReport report = verify({nullptr, nullptr, nullptr, &mesh}, {}, context);
  ASSERT_TRUE(report.surface && report.volume);
  EXPECT_TRUE(report.surface->closed);
  EXPECT_NEAR(*report.surface->volume_mm3, report.volume->volume_mm3, 1e-15);
}

TEST(Verify, AnIsosurfaceGivesDistancesInVoxels) {
  Isosurface isosurface;
  isosurface.surface = test::sphere_surface({0, 0, 50}, 10, 3);
  isosurface.surface.voxel_mm = 2;
  const SurfaceMesh surface = test::sphere_surface({0, 0, 50}, 10.2, 3);
  Context context;
  const QualityReport report = verify({&isosurface, nullptr, &surface, nullptr}, {}, context);
  ASSERT_TRUE(report.surface->distance.has_value());
  EXPECT_EQ(report.surface->distance->unit, "voxel");
  EXPECT_NEAR(report.surface->distance->hausdorff, 0.1, 0.005);
  EXPECT_NEAR(*report.surface->volume_change, 1.02 * 1.02 * 1.02 - 1, 1e-9);
}

// A ball and a crumb far from it; the crumb is not in the result.
TEST(Verify, ComponentsDroppedOnRequestAreNotMissed) {
  Isosurface isosurface;
  isosurface.surface = test::sphere_surface({0, 0, 50}, 10, 3);
  const SurfaceMesh ball = isosurface.surface, crumb = test::sphere_surface({40, 0, 50}, 1, 0);
  const auto first = static_cast<Index>(ball.points.size());
  isosurface.surface.points.insert(isosurface.surface.points.end(), crumb.points.begin(), crumb.points.end());
  for (const Triangle& t : crumb.triangles) {
    isosurface.surface.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  isosurface.surface.voxel_mm = 1;
  SimplexMesh decimated;
  decimated.report.requested_distance_mm = 0.3;
  Context context;
  const QualityReport missed = verify({&isosurface, &decimated, &ball, nullptr}, {}, context);
  EXPECT_EQ(missed.verdict, Verdict::kFail);
  EXPECT_GT(missed.surface->distance->hausdorff, 25);
  decimated.report.dropped_below = crumb.triangles.size() + 1;
  const QualityReport whole = verify({&isosurface, &decimated, &ball, nullptr}, {}, context);
  EXPECT_EQ(whole.verdict, Verdict::kPass);
  EXPECT_LT(whole.surface->distance->hausdorff, 1e-9);
  decimated.report.dropped_below = crumb.triangles.size();  // as large as asked: it should be there
  EXPECT_EQ(verify({&isosurface, &decimated, &ball, nullptr}, {}, context).verdict, Verdict::kFail);
}

TEST(Verify, MechanicsIsMeasuredWhereThePresetIsForFiniteElements) {
  const TetMesh mesh = test::box_mesh({.cells = {3, 3, 3}, .shake = 0.1});
  Context context;
  const auto with = [&](Preset preset, MechanicsCheck check) {
    VerifyOptions options;
    options.preset = preset;
    options.mechanics = check;
    return verify({nullptr, nullptr, nullptr, &mesh}, options, context);
  };
  EXPECT_TRUE(with(Preset::kFeStandard, MechanicsCheck::kByPreset).mechanics);
  EXPECT_TRUE(with(Preset::kFeStrict, MechanicsCheck::kByPreset).mechanics);
  EXPECT_FALSE(with(Preset::kLenient, MechanicsCheck::kByPreset).mechanics);
  EXPECT_FALSE(with(Preset::kNone, MechanicsCheck::kByPreset).mechanics);
  EXPECT_FALSE(with(Preset::kFeStrict, MechanicsCheck::kNone).mechanics);
  EXPECT_TRUE(with(Preset::kNone, MechanicsCheck::kBasic).mechanics);
}

// A box of two cells a side with its far corner at the origin, and another whose near corner is there.
TetMesh two_boxes(Vec3 apart) {
  const test::BoxMeshOptions first{.low = {-2, -2, -2}, .cell = {1, 1, 1}, .cells = {2, 2, 2}};
  TetMesh mesh = test::box_mesh(first);
  const TetMesh other = test::box_mesh({.low = apart, .cell = {1, 1, 1}, .cells = {2, 2, 2}});
  std::vector<Index> number;
  for (const Vec3 p : other.points) {
    const auto same = std::find(mesh.points.begin(), mesh.points.end(), p);
    number.push_back(static_cast<Index>(same - mesh.points.begin()));
    if (same == mesh.points.end()) mesh.points.push_back(p);
  }
  for (const auto& [a, b, c, d] : other.tets) {
    mesh.tets.push_back({number[a], number[b], number[c], number[d]});
  }
  mesh.boundary.clear();
  return mesh;
}

TEST(Verify, ABodyWithAHingeFailsItsGateAndTwoBodiesDoNot) {
  Context context;
  VerifyOptions options;
  options.preset = Preset::kNone;
  options.mechanics = MechanicsCheck::kBasic;
  options.gates["mechanics.rigid_modes"].limit = 6;
  const auto verdict_of = [&](Vec3 apart) {
    const TetMesh mesh = two_boxes(apart);
    return verify({nullptr, nullptr, nullptr, &mesh}, options, context).verdict;
  };
  EXPECT_EQ(verdict_of({0, 0, 0}), Verdict::kFail) << "a corner is shared";
  EXPECT_EQ(verdict_of({3, 0, 0}), Verdict::kPass);
}

// A bar against a finer mesh of itself, and against a thicker one.
TEST(Verify, ComparesWithTheReferenceUnderALoad) {
  const TetMesh mesh = test::box_mesh({.cell = {2, 2, 3}, .cells = {2, 2, 14}});
  const TetMesh same = test::box_mesh({.cell = {1, 1, 2}, .cells = {4, 4, 21}});
  const TetMesh thicker = test::box_mesh({.cell = {1.1, 1, 2}, .cells = {4, 4, 21}});
  VerifyOptions options;
  options.mechanics = MechanicsCheck::kReference;
  Context context;
  const auto gate = [](const QualityReport& report, const std::string& path) {
    const auto found = std::find_if(report.gates.begin(), report.gates.end(),
                                    [&](const GateResult& result) { return result.metric == path; });
    return found == report.gates.end() ? std::nullopt : std::optional(found->status);
  };
  const QualityReport good = verify({nullptr, nullptr, nullptr, &mesh, &same}, options, context);
  ASSERT_TRUE(good.mechanics && good.mechanics->reference);
  EXPECT_EQ(good.mechanics->reference->axis, "z");
  EXPECT_NEAR(good.mechanics->reference->stiffness, 0, 0.01);
  EXPECT_EQ(gate(good, "mechanics.reference.stiffness"), Verdict::kPass);
  EXPECT_EQ(gate(good, "mechanics.reference.p95_von_mises"), Verdict::kPass);
  const QualityReport bad = verify({nullptr, nullptr, nullptr, &mesh, &thicker}, options, context);
  EXPECT_NEAR(bad.mechanics->reference->stiffness, 1 / 1.1 - 1, 0.01);
  EXPECT_EQ(gate(bad, "mechanics.reference.stiffness"), Verdict::kFail);
  EXPECT_EQ(gate(bad, "mechanics.reference.energy"), Verdict::kFail);
}

// The bar against a thicker one with a budget that lacks a byte for the second order of the finer mesh.
class VerifyAtFirstOrder : public testing::Test {
 protected:
  QualityReport report(const GateOverrides& gates = {}) {
    VerifyOptions options;
    options.preset = Preset::kLenient;
    options.mechanics = MechanicsCheck::kReference;
    options.gates = gates;
    return verify({nullptr, nullptr, nullptr, &mesh_, &thicker_}, options, context_);
  }
  void allow(std::size_t bytes) { context_.memory_bytes = 2 * bytes; }
  // How often a code was logged.
  std::size_t logged(const std::string& code) const {
    return static_cast<std::size_t>(std::count(codes_.begin(), codes_.end(), code));
  }

  const TetMesh mesh_ = test::box_mesh({.cell = {1, 1, 2}, .cells = {4, 4, 21}});
  const TetMesh thicker_ = test::box_mesh({.cell = {1, 1, 2}, .cells = {5, 4, 21}});
  Context context_;

 private:
  void SetUp() override {
    context_.sink = [this](const Event& event) { codes_.push_back(event.code); };
  }
  std::vector<std::string> codes_;
};

std::size_t gates_on_reference(const QualityReport& report) {
  return static_cast<std::size_t>(std::count_if(
      report.gates.begin(), report.gates.end(),
      [](const GateResult& gate) { return gate.metric.rfind("mechanics.reference.", 0) == 0; }));
}

TEST_F(VerifyAtFirstOrder, IsWhatTheSecondOrderIsNotWhereThatFits) {
  allow(stretch_bytes(thicker_, 2));
  const QualityReport second = report();
  ASSERT_TRUE(second.mechanics && second.mechanics->reference);
  EXPECT_EQ(second.mechanics->reference->order, 2);
  EXPECT_EQ(gates_on_reference(second), 3U);
  EXPECT_EQ(second.verdict, Verdict::kFail) << "a fifth of the width is missing";
  EXPECT_EQ(logged("mechanics.first_order"), 0U);
}

TEST_F(VerifyAtFirstOrder, ComparesBothMeshesWithoutAGateAndSaysSo) {
  allow(stretch_bytes(thicker_, 2) - 1);
  ASSERT_LE(stretch_bytes(mesh_, 2), stretch_bytes(thicker_, 2) - 1) << "the smaller mesh alone would fit";
  const QualityReport first = report({{"mechanics.reference.energy", {0.001, std::nullopt}}});
  ASSERT_TRUE(first.mechanics && first.mechanics->reference);
  const ReferenceQuality& reference = *first.mechanics->reference;
  EXPECT_EQ(reference.order, 1);
  EXPECT_NEAR(reference.stiffness, 4.0 / 5 - 1, 0.01) << "elements of one size compare fairly";
  EXPECT_NEAR(reference.energy, 4.0 / 5 - 1, 0.01);
  EXPECT_EQ(reference.mesh.nodes, mesh_.points.size());
  EXPECT_EQ(reference.fine.nodes, thicker_.points.size());
  EXPECT_EQ(gates_on_reference(first), 0U) << "not even the one asked for";
  EXPECT_EQ(first.verdict, Verdict::kPass);
  EXPECT_EQ(logged("mechanics.first_order"), 1U);
}

TEST_F(VerifyAtFirstOrder, FailsAGateOnTheOrder) {
  allow(stretch_bytes(thicker_, 2) - 1);
  EXPECT_EQ(report({{"mechanics.reference.order", {2, std::nullopt}}}).verdict, Verdict::kFail);
}

TEST_F(VerifyAtFirstOrder, LeavesOutWhatDoesNotFitThereEither) {
  allow(stretch_bytes(thicker_, 1) - 1);
  const QualityReport none = report();
  ASSERT_TRUE(none.mechanics.has_value());
  EXPECT_FALSE(none.mechanics->reference.has_value());
  EXPECT_EQ(logged("mechanics.too_large"), 1U);
  EXPECT_EQ(logged("mechanics.first_order"), 0U);
}

}  // namespace
}  // namespace periost
