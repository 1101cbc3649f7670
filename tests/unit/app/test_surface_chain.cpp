// Chains that start from a surface file, as the built program runs them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "pipeline/base/file.h"
#include "pipeline/io/surface_write.h"
#include "tests/support/process.h"
#include "tests/support/surfaces.h"

namespace periost::test {
namespace {

using testing::HasSubstr;

class SurfaceChain : public testing::Test {
 protected:
  ProcessResult run(const std::string& more = "") {
    const auto config =
        folder_.write("case.yaml", "periost: 1\nchain:\n  - {stage: read_surface, path: a.stl" + more +
                                       "}\n  - stage: tetgen\n  - {stage: verify, preset: none}\n");
    return run_process(
        {periost_program(), "run", config.string(), "--out", (folder_.path() / "out").string()});
  }
  void write(const SurfaceMesh& mesh) { write_surface(mesh, folder_.path() / "a.stl"); }

  TemporaryFolder folder_;
};

TEST_F(SurfaceChain, AClosedSurfaceIsFilledAndMeasured) {
  write(sphere_surface({120, -40, 90}, 20, 2));
  const ProcessResult result = run();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const auto quality = nlohmann::json::parse(read_text(folder_.path() / "out" / "quality.json"));
  EXPECT_GT(quality["volume"]["tets"], 100);
  EXPECT_EQ(quality["volume"]["boundary_preserved"], true);
  EXPECT_NEAR(quality["volume"]["volume_mm3"].get<double>(), quality["surface"]["volume_mm3"].get<double>(),
              1e-6);
}

TEST_F(SurfaceChain, ASurfaceWithoutAnImageIsDecimatedAgainstItself) {
  write(sphere_surface({120, -40, 90}, 20, 4));
  const auto config =
      folder_.write("case.yaml",
                    "periost: 1\nchain:\n  - {stage: read_surface, path: a.stl}\n"
                    "  - {stage: decimate, distance: 0.3 mm}\n  - stage: triangulate\n"
                    "  - stage: tetgen\n  - stage: improve\n  - {stage: verify, preset: none}\n");
  const ProcessResult result =
      run_process({periost_program(), "run", config.string(), "--out", (folder_.path() / "out").string()});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const auto quality = nlohmann::json::parse(read_text(folder_.path() / "out" / "quality.json"));
  EXPECT_GT(quality["decimation"]["rate"], 0.5);
  const auto& distance = quality["surface"]["distance"];
  EXPECT_EQ(distance["unit"], "mm");
  EXPECT_LE(distance["hausdorff"], 0.3);
  EXPECT_GT(distance["hausdorff"], 0.05) << "it is measured to what was read";
}

TEST_F(SurfaceChain, AnOpenSurfaceIsTheInputsFault) {
  SurfaceMesh sphere = sphere_surface({120, -40, 90}, 20, 1);
  sphere.triangles.pop_back();
  write(sphere);
  const ProcessResult refused = run();
  EXPECT_EQ(refused.exit_code, 4);
  EXPECT_THAT(refused.err, HasSubstr("stage 'read_surface'"));
  EXPECT_THAT(refused.err, HasSubstr("[surface.open]"));
}

TEST_F(SurfaceChain, WhatAnyLetsThroughTetgenRefusesAsInput) {
  SurfaceMesh sphere = sphere_surface({120, -40, 90}, 20, 1);
  sphere.triangles.pop_back();
  write(sphere);
  const ProcessResult refused = run(", require: any");
  EXPECT_EQ(refused.exit_code, 4);
  EXPECT_THAT(refused.err, HasSubstr("stage 'tetgen'"));
  EXPECT_THAT(refused.err, HasSubstr("[surface.open]"));
}

TEST_F(SurfaceChain, ASurfaceThatCrossesItselfIsRefusedByTetgenAsInput) {
  write(joined(sphere_surface({0, 0, 0}, 10, 1), sphere_surface({7, 3, 1}, 10, 1)));
  const ProcessResult refused = run();
  EXPECT_EQ(refused.exit_code, 4);
  EXPECT_THAT(refused.err, HasSubstr("stage 'tetgen'"));
  EXPECT_THAT(refused.err, HasSubstr("[surface.self_intersection]"));
}

TEST_F(SurfaceChain, AMissingFileIsADiagnosticBeforeAnythingRuns) {
  const ProcessResult refused = run();
  EXPECT_EQ(refused.exit_code, 4);
  EXPECT_THAT(refused.err, HasSubstr("case.yaml:3:"));
  EXPECT_THAT(refused.err, HasSubstr("[surface.missing]"));
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "out"));
}

}  // namespace
}  // namespace periost::test
