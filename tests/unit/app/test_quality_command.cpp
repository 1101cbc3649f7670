#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "pipeline/io/surface_write.h"
#include "tests/support/process.h"
#include "tests/support/surfaces.h"

namespace periost::test {
namespace {

using testing::HasSubstr;

class QualityOfFiles : public testing::Test {
 protected:
  QualityOfFiles() { write_surface(sphere_surface({120, -40, 90}, 20, 2), mesh_); }
  ProcessResult quality(std::vector<std::string> more) const {
    std::vector<std::string> arguments{periost_program(), "quality"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_process(arguments);
  }

  TemporaryFolder folder_;
  std::string mesh_ = (folder_.path() / "a.ply").string();
};

TEST_F(QualityOfFiles, TextIsOneMetricALine) {
  const ProcessResult result = quality({mesh_});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, testing::ContainsRegex("surface.triangles +320 "));
  EXPECT_THAT(result.out, testing::ContainsRegex("surface.self_intersections +0 "));
  EXPECT_THAT(result.out, testing::Not(HasSubstr("volume.tets")));
  EXPECT_EQ(result.err, "");
}

TEST_F(QualityOfFiles, JsonFollowsTheSchemaWithTheDistanceToAReference) {
  const std::string reference = (folder_.path() / "b.ply").string();
  write_surface(sphere_surface({120, -40, 90}, 20.5, 2), reference);
  const ProcessResult result = quality({mesh_, "--reference", reference, "--format", "json"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const auto document = nlohmann::json::parse(result.out);
  EXPECT_EQ(document["schema"], "periost-quality/1");
  EXPECT_EQ(document["surface"]["euler"], 2);
  EXPECT_EQ(document["surface"]["distance"]["unit"], "mm");
  EXPECT_NEAR(document["surface"]["distance"]["hausdorff"].get<double>(), 0.5, 0.02);
}

TEST_F(QualityOfFiles, AGatePassesWith0AndFailsWith3) {
  EXPECT_EQ(quality({mesh_, "--gate", "surface.min_angle_deg.min=30"}).exit_code, 0);
  const ProcessResult failed = quality({mesh_, "--gate", "surface.min_angle_deg.min=59.9"});
  EXPECT_EQ(failed.exit_code, 3);
  EXPECT_THAT(failed.out, HasSubstr("fail: surface.min_angle_deg.min is "));
  EXPECT_THAT(failed.out, HasSubstr("verdict: fail"));
}

TEST_F(QualityOfFiles, UnreadableMeshesAreTheInputsFault) {
  const ProcessResult missing = quality({(folder_.path() / "absent.stl").string()});
  EXPECT_EQ(missing.exit_code, 4);
  EXPECT_THAT(missing.err, HasSubstr("[surface.missing]"));
  const ProcessResult broken = quality({folder_.write("a.off", "OFF\n3 1 0\n0 0 0\n").string()});
  EXPECT_EQ(broken.exit_code, 4) << broken.err;
}

TEST_F(QualityOfFiles, UnknownMetricsAndLimitsThatAreNoneAreUsage) {
  const ProcessResult unknown = quality({mesh_, "--gate", "surface.min_angle_deg.mim=30"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("did you mean 'surface.min_angle_deg.min'?"));
  EXPECT_EQ(quality({mesh_, "--gate", "surface.min_angle_deg.min"}).exit_code, 2);
  EXPECT_EQ(quality({mesh_, "--preset", "fe-strickt"}).exit_code, 2);
}

}  // namespace
}  // namespace periost::test
