// A chain that compares the decimated mesh with the undecimated one, as the built program runs it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "pipeline/base/file.h"
#include "tests/support/process.h"

namespace periost::test {
namespace {

using testing::HasSubstr;

constexpr const char* kImage = R"(periost: 1
chain:
  - {stage: phantom, shape: cube, size: [32, 32, 32]}
  - {stage: threshold, lower: 0.5}
  - stage: marching_cubes
)";
constexpr const char* kMesh = R"(  - {stage: decimate, distance: 0.15 voxel}
  - stage: triangulate
  - stage: tetgen
  - stage: improve
)";

class ReferenceChain : public testing::Test {
 protected:
  ProcessResult run(const std::string& chain) {
    const auto config = folder_.write("case.yaml", chain);
    return run_process(
        {periost_program(), "run", config.string(), "--out", (folder_.path() / "out").string()});
  }
  TemporaryFolder folder_;
};

TEST_F(ReferenceChain, FillsTheIsosurfaceInABranchAndComparesWithIt) {
  const ProcessResult result =
      run(std::string(kImage) + "  - {stage: tetgen, id: fine, from: {surface: marching_cubes}}\n" + kMesh +
          "  - {stage: verify, preset: none, mechanics: reference, "
          "from: {reference: fine}}\n");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto quality = nlohmann::json::parse(read_text(folder_.path() / "out" / "quality.json"));
  const auto& reference = quality["mechanics"]["reference"];
  EXPECT_GT(reference["fine"]["tets"], 2 * reference["mesh"]["tets"].get<int>());
  EXPECT_LT(std::abs(reference["stiffness"].get<double>()), 0.02);
  EXPECT_LT(std::abs(reference["energy"].get<double>()), 0.02);
  EXPECT_LT(std::abs(reference["p95_von_mises"].get<double>()), 0.05);
  EXPECT_EQ(quality["volume"]["tets"], reference["mesh"]["tets"]) << "the mesh measured is the newest";
}

TEST_F(ReferenceChain, WithoutABranchItIsRefusedBeforeItRuns) {
  const ProcessResult refused =
      run(std::string(kImage) + kMesh + "  - {stage: verify, mechanics: reference}\n");
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, HasSubstr("[verify.no_reference]"));
  EXPECT_THAT(refused.err, HasSubstr("from: {reference: ID}"));
}

}  // namespace
}  // namespace periost::test
