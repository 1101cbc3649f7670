#include "pipeline/run/plan.h"

#include <gmock/gmock.h>

#include "pipeline/config/emit.h"
#include "tests/support/sample_stages.inl"

namespace periost {
namespace {

struct NoOptions {};

// image -> isosurface
class ExtractStage final : public StageOf<NoOptions> {
 public:
  void declare(Declaration<NoOptions>& d) const override {
    d.stage("extract", 1, "Extracts.")
        .input<Image>("image", "The image.")
        .output<Isosurface>("isosurface", "The isosurface.", {.closed = true});
  }
  Outputs run(const NoOptions&, const Inputs&, Context&) const override { return {Isosurface()}; }
};

// isosurface -> surface
class CoarsenStage final : public StageOf<NoOptions> {
 public:
  void declare(Declaration<NoOptions>& d) const override {
    d.stage("coarsen", 1, "Coarsens.")
        .input<Isosurface>("isosurface", "The isosurface.")
        .output<SurfaceMesh>("surface", "The coarse one.");
  }
  Outputs run(const NoOptions&, const Inputs&, Context&) const override { return {SurfaceMesh()}; }
};

// an isosurface where there is one
class JudgeStage final : public StageOf<NoOptions> {
 public:
  void declare(Declaration<NoOptions>& d) const override {
    d.stage("judge", 1, "Judges.")
        .optional_input<Isosurface>("isosurface", "What it is compared with.")
        .output<QualityReport>("quality", "How it is.");
  }
  Outputs run(const NoOptions&, const Inputs&, Context&) const override { return {QualityReport()}; }
};

// tet_mesh, and a second one by name only
class AgainstStage final : public StageOf<NoOptions> {
 public:
  void declare(Declaration<NoOptions>& d) const override {
    d.stage("against", 1, "Compares.")
        .named_input<TetMesh>("reference", "What it should be.")
        .input<TetMesh>("tet_mesh", "The mesh.")
        .output<QualityReport>("quality", "How they differ.");
  }
  Outputs run(const NoOptions&, const Inputs&, Context&) const override { return {QualityReport()}; }
};

class PlanTest : public testing::Test {
 protected:
  PlanTest() { sample::register_stages(registry_); }

  Plan plan(const std::string& chain, const std::vector<std::string>& overrides = {},
            const std::string& file = "/data/configs/femur.yaml") {
    Diagnostics diagnostics;
    const Configuration configuration = parse_configuration(chain, file, overrides, diagnostics);
    Plan plan = make_plan(configuration, registry_, diagnostics);
    for (const Diagnostic& diagnostic : diagnostics) ADD_FAILURE() << format(diagnostic);
    return plan;
  }

  Registry registry_;
};

constexpr const char* kChain = R"(periost: 1
chain:
  - stage: read
    path: ../ct.nii
  - stage: mesh
  - stage: tets
)";

TEST_F(PlanTest, TakesTheNewestOfEachKind) {
  const Plan p = plan(R"(periost: 1
chain:
  - {stage: read, path: a.nii}
  - {stage: read, path: b.nii}
  - {stage: mesh}
  - {stage: mesh, from: read, id: first}
  - {stage: tets}
  - {stage: tets, from: mesh}
  - {stage: compare, from: [mesh, first]}
  - {stage: compare, from: {reference: mesh}}
)");
  EXPECT_EQ(p.name, "femur");
  EXPECT_EQ(p.steps.at(1).id, "read_2");
  EXPECT_EQ(p.steps.at(2).inputs.at(0).step, 1u);
  EXPECT_EQ(p.steps.at(3).inputs.at(0).step, 0u);
  EXPECT_EQ(p.steps.at(4).inputs.at(0).step, 3u);
  EXPECT_EQ(p.steps.at(5).inputs.at(0).step, 2u);
  EXPECT_EQ(p.steps.at(6).inputs.at(0).step, 2u);
  EXPECT_EQ(p.steps.at(6).inputs.at(1).step, 3u);
  EXPECT_EQ(p.steps.at(7).inputs.at(0).step, 3u);
  EXPECT_EQ(p.steps.at(7).inputs.at(1).step, 2u);
}

TEST_F(PlanTest, PicksOneOfSeveralOutputs) {
  const Plan p = plan(R"(periost: 1
chain:
  - {stage: read, path: a.nii}
  - {stage: twins}
  - {stage: tets, from: twins.right}
  - {stage: compare, from: {surface: twins.right, reference: twins.left}}
)");
  EXPECT_EQ(p.steps.at(2).inputs.at(0).output, 1u);
  EXPECT_EQ(p.steps.at(3).inputs.at(0).output, 1u);
  EXPECT_EQ(p.steps.at(3).inputs.at(1).output, 0u);
}

TEST_F(PlanTest, ANamedInputIsConnectedByItsNameAlone) {
  register_stage(registry_, std::make_unique<AgainstStage>());
  const Plan p = plan(R"(periost: 1
chain:
  - {stage: read, path: a.nii}
  - {stage: mesh}
  - {stage: tets, id: fine}
  - {stage: tets, id: coarse}
  - {stage: against}
  - {stage: against, from: fine}
  - {stage: against, from: {reference: fine}}
)");
  for (const std::size_t step : {4u, 5u}) {
    ASSERT_EQ(p.steps.at(step).inputs.size(), 1u);
    EXPECT_EQ(p.steps.at(step).inputs[0].port, "tet_mesh");
  }
  ASSERT_EQ(p.steps.at(6).inputs.size(), 2u);
  EXPECT_EQ(p.steps.at(6).inputs[0].port, "reference");
  EXPECT_EQ(p.steps.at(6).inputs[0].step, 2u);
  EXPECT_EQ(p.steps.at(6).inputs[1].step, 3u);
  EXPECT_EQ(p.steps.at(6).inputs[1].kind, ArtefactKind::kTetMesh);
}

TEST_F(PlanTest, AnIsosurfaceStandsForASurfaceWhereItIsNamed) {
  register_stage(registry_, std::make_unique<ExtractStage>());
  const Plan p = plan(R"(periost: 1
chain:
  - {stage: read, path: a.nii}
  - {stage: mesh}
  - {stage: extract}
  - {stage: tets}
  - {stage: tets, from: {surface: extract}}
)");
  EXPECT_EQ(p.steps.at(3).inputs.at(0).step, 1u) << "the newest surface is no isosurface";
  EXPECT_EQ(p.steps.at(4).inputs.at(0).step, 2u);
  EXPECT_EQ(p.steps.at(4).inputs.at(0).kind, ArtefactKind::kSurface);
  const auto isosurface = std::make_shared<const Isosurface>();
  const Artefact surface = as_surface(isosurface);
  EXPECT_EQ(std::get<std::shared_ptr<const SurfaceMesh>>(surface).get(), &isosurface->surface);
}

TEST_F(PlanTest, ASurfaceStandsForAnIsosurfaceWhereNoneIsMade) {
  register_stage(registry_, std::make_unique<ExtractStage>());
  register_stage(registry_, std::make_unique<CoarsenStage>());
  register_stage(registry_, std::make_unique<JudgeStage>());
  const Plan read = plan(R"(periost: 1
chain:
  - {stage: read, path: a.nii}
  - {stage: mesh}
  - {stage: judge, id: before}
  - {stage: coarsen}
  - {stage: judge}
)");
  EXPECT_TRUE(read.steps.at(2).inputs.empty()) << "it does not need one";
  EXPECT_EQ(read.steps.at(3).inputs.at(0).step, 1u);
  EXPECT_EQ(read.steps.at(3).inputs.at(0).kind, ArtefactKind::kIsosurface);
  EXPECT_EQ(read.steps.at(4).inputs.at(0).step, 1u) << "what was coarsened, not what came out of it";
  const Plan made = plan(R"(periost: 1
chain:
  - {stage: read, path: a.nii}
  - {stage: extract}
  - {stage: mesh}
  - {stage: coarsen}
  - {stage: coarsen, id: other, from: {isosurface: mesh}}
)");
  EXPECT_EQ(made.steps.at(3).inputs.at(0).step, 1u) << "an isosurface that is made counts, however old";
  EXPECT_EQ(made.steps.at(4).inputs.at(0).step, 2u) << "unless another surface is named";
}

TEST_F(PlanTest, PreflightSeesForecastsAndSumsMemory) {
  const Plan p = plan(kChain);
  EXPECT_EQ(p.steps.at(1).outputs.at("surface").triangles, 1000u);
  EXPECT_THAT(p.steps.at(0).reads, testing::ElementsAre("/data/ct.nii"));
  // The mesh step holds the image (4 MB) beside its own peak.
  EXPECT_EQ(p.peak_bytes, 4000000u + 500u);
}

TEST_F(PlanTest, OverridesReachNestedKeysAndLists) {
  const Plan p =
      plan(kChain, {"mesh.distance=0.45mm", "mesh.format=[vtp, ply]", "mesh.format[1]=obj",
                    R"(mesh.gates."volume.min".limit=8)", "mesh.gates.volume.min.warn=12", "seed=7"});
  const auto& options = std::any_cast<const sample::MeshOptions&>(p.steps.at(1).options);
  EXPECT_EQ(options.distance, Length::mm(0.45));
  EXPECT_THAT(options.format, testing::ElementsAre("vtp", "obj"));
  EXPECT_EQ(options.gates.at("volume.min").limit, 8);
  EXPECT_EQ(options.gates.at("volume.min").warn, 12);
  EXPECT_EQ(p.seed, 7u);
}

TEST_F(PlanTest, ResolvedConfigurationGivesTheSamePlan) {
  const Plan first = plan(R"(periost: 1
name: a ${HOME}
seed: 18446744073709551615
plugins: []
provenance: {dicom_uids: true, paths: none}
chain:
  - {stage: read, path: "../c t/$${x}.nii"}
  - {stage: twins}
  - {stage: mesh, distance: 0.1 voxel, keep: 3, gates: {volume.min: {limit: 8}}}
  - {stage: compare, from: [twins.right, mesh]}
)",
                          {"name=x"});
  const Value resolved = resolved_configuration(first, "/data/runs/x");
  const std::string text = emit_yaml(resolved);
  EXPECT_THAT(text, testing::HasSubstr("\"../../c t/$${x}.nii\""));
  EXPECT_THAT(text, testing::HasSubstr("iterations: 10"));
  const Plan second = plan(text, {}, "/data/runs/x/config.yaml");
  EXPECT_EQ(emit_yaml(resolved_configuration(second, "/data/runs/x")), text);
  for (std::size_t i = 0; i < first.steps.size(); ++i) {
    Value a = first.steps[i].params, b = second.steps[i].params;
    EXPECT_EQ(emit_yaml(a), emit_yaml(b));
    ASSERT_EQ(first.steps[i].inputs.size(), second.steps[i].inputs.size());
    for (std::size_t k = 0; k < first.steps[i].inputs.size(); ++k) {
      EXPECT_EQ(first.steps[i].inputs[k].step, second.steps[i].inputs[k].step);
      EXPECT_EQ(first.steps[i].inputs[k].output, second.steps[i].inputs[k].output);
    }
  }
  EXPECT_EQ(second.seed, 18446744073709551615ull);
}

}  // namespace
}  // namespace periost
