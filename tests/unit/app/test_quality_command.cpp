#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "pipeline/io/surface_write.h"
#include "pipeline/io/volume_write.h"
#include "tests/support/process.h"
#include "tests/support/surfaces.h"
#include "tests/support/tet_meshes.h"

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

TEST_F(QualityOfFiles, MechanicsOfAVolumeWhenAsked) {
  const std::string volume = (folder_.path() / "v.vtu").string();
  write_vtu(box_mesh({.cells = {3, 3, 3}, .order = 2}), volume);
  EXPECT_THAT(quality({volume}).out, testing::Not(HasSubstr("mechanics.")));
  const ProcessResult basic = quality({volume, "--mechanics", "basic", "--preset", "lenient"});
  EXPECT_EQ(basic.exit_code, 0) << basic.err;
  EXPECT_THAT(basic.out, testing::ContainsRegex("mechanics.rigid_modes +6 "));
  EXPECT_THAT(basic.out, HasSubstr("mechanics.cg_ratio"));
  EXPECT_EQ(quality({volume, "--mechanics", "basic", "--gate", "mechanics.cg_ratio=0.1"}).exit_code, 3);
}

// A cube of six tetrahedra around a diagonal, as Gmsh and TetGen would write it.
TEST_F(QualityOfFiles, VolumesOfOtherProgramsWithReferenceAndGates) {
  const SurfaceMesh box = box_surface({0, 0, 0}, {2, 2, 2});
  std::string points, msh = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n8\n", tets, ele = "6 4 0\n";
  for (std::size_t p = 0; p < 8; ++p) {
    const auto& [x, y, z] = box.points[p];
    points += std::to_string(p + 1) + " " + std::to_string(x) + " " + std::to_string(y) + " " +
              std::to_string(z) + "\n";
  }
  constexpr int kTets[6][4] = {{1, 2, 4, 8}, {1, 4, 3, 8}, {1, 3, 7, 8},
                               {1, 7, 5, 8}, {1, 5, 6, 8}, {1, 6, 2, 8}};
  for (int t = 0; t < 6; ++t) {
    const auto& [a, b, c, d] = kTets[t];
    const std::string corners = std::to_string(a) + " " + std::to_string(b) + " " + std::to_string(c) + " " +
                                std::to_string(d) + "\n";
    tets += std::to_string(t + 1) + " 4 2 1 1 " + corners;
    ele += std::to_string(t + 1) + " " + corners;
  }
  folder_.write("cube.node", "8 3 0 0\n" + points);
  const std::string reference = (folder_.path() / "box.stl").string();
  write_surface(box_surface({0, 0, -0.25}, {2, 2, 2}), reference);
  for (const auto& [name, text] :
       {std::pair{"cube.msh", msh + points + "$EndNodes\n$Elements\n6\n" + tets + "$EndElements\n"},
        std::pair{"cube.ele", ele}}) {
    const ProcessResult result =
        quality({folder_.write(name, text).string(), "--reference", reference, "--format", "json"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const auto document = nlohmann::json::parse(result.out);
    EXPECT_EQ(document["volume"]["tets"], 6);
    EXPECT_NEAR(document["volume"]["volume_mm3"].get<double>(), 8, 1e-12);
    EXPECT_NEAR(document["volume"]["min_dihedral_deg"]["min"].get<double>(), 45, 1e-9);
    EXPECT_EQ(document["surface"]["triangles"], 12);
    EXPECT_NEAR(document["surface"]["distance"]["hausdorff"].get<double>(), 0.25, 1e-6);
    const ProcessResult strict = quality({(folder_.path() / name).string(), "--preset", "fe-strict"});
    EXPECT_EQ(strict.exit_code, 0) << strict.out;
    EXPECT_EQ(
        quality({(folder_.path() / name).string(), "--gate", "volume.min_dihedral_deg.min=46"}).exit_code, 3);
  }
  const ProcessResult surface = quality({mesh_, "--reference", (folder_.path() / "cube.ele").string()});
  EXPECT_EQ(surface.exit_code, 0) << surface.err;
  EXPECT_THAT(surface.out, HasSubstr("surface.distance.hausdorff"));
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
