// examples/thin_cortex, seen from outside: round 1 fails by its thin cortex, a later round passes, and where
// the cortex is thick the mesh stays as it was.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "pipeline/base/file.h"
#include "pipeline/io/surface_read.h"
#include "tests/support/process.h"

namespace periost::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::Contains;

json read_json(const fs::path& path) {
  return json::parse(read_text(path));
}

// Vertices between two heights, mm.
std::size_t vertices_between(const fs::path& surface, double low, double high) {
  const SurfaceMesh mesh = read_surface(surface);
  return static_cast<std::size_t>(std::count_if(mesh.points.begin(), mesh.points.end(),
                                                [&](Vec3 p) { return p.z >= low && p.z < high; }));
}

TEST(ThinCortex, FailsFirstThenPassesByShorterEdgesWhereTheCortexIsThin) {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "out", first = out / "rounds/1";
  const ProcessResult result =
      run_process({periost_program(), "run", PERIOST_SOURCE_DIR "/examples/thin_cortex/femur.yaml",
                   "--progress", "none", "--out", out.string()});
  ASSERT_EQ(result.exit_code, 0) << result.err;

  const json rounds = read_json(out / "run.json").at("rounds");
  ASSERT_GE(rounds.size(), 2u);
  EXPECT_EQ(rounds.front().at("verdict"), "fail");
  EXPECT_THAT(rounds.front().at("failed_gates").get<std::vector<std::string>>(),
              Contains("volume.scaled_jacobian.p01"));
  EXPECT_NE(rounds.back().at("verdict"), "fail");
  EXPECT_EQ(rounds.back().at("ended"), "pass");
  EXPECT_EQ(rounds.back().at("best"), true);
  EXPECT_TRUE(rounds.front().at("changed").contains("decimate.refine"));

  for (const char* name : {"surface.vtp", "volume.vtu", "quality.json", "hints.json"})
    EXPECT_TRUE(fs::exists(first / name)) << name;
  EXPECT_EQ(read_json(first / "quality.json").at("verdict"), "fail");
  EXPECT_NE(read_json(out / "quality.json").at("verdict"), "fail");
  EXPECT_TRUE(fs::exists(out / "surface.stl"));  // behind verify: only of the round that passed
  EXPECT_FALSE(fs::exists(first / "surface.stl"));

  // Both ends are finer than twice before; the shaft, 80 to 130 mm, is not.
  const auto shaft = [](const fs::path& run) { return vertices_between(run / "surface.vtp", 80, 130); };
  const auto low_end = [](const fs::path& run) { return vertices_between(run / "surface.vtp", 20, 60); };
  EXPECT_LT(shaft(out), 2 * shaft(first));
  EXPECT_GT(low_end(out), 2 * low_end(first));
}

}  // namespace
}  // namespace periost::test
