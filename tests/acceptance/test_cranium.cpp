// The main job on a real CT, seen from outside: what the program left is measured again by the `quality` command, by an
// independent checker, and by a solver. Needs PERIOST_CRANIUM (scripts/fetch_data.sh prints it) and, for one test,
// PERIOST_MESHMETRICS.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const fs::path kProgram = fs::path(PERIOST_BUILD_DIR) / "bin/periost";
const fs::path kOut = fs::path(PERIOST_BUILD_DIR) / "acceptance/cranium";

struct Finished {
  int exit_code = -1;
  std::string output;
};

Finished shell(const std::string& command) {
  Finished finished;
  FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  for (char buffer[4096]; fgets(buffer, sizeof buffer, pipe) != nullptr;) finished.output += buffer;
  finished.exit_code = WEXITSTATUS(pclose(pipe));
  return finished;
}

json read_json(const fs::path& path) {
  std::ifstream file(path);
  return json::parse(file);
}

// Output files of a run by kind and name with their hashes, without the parts that tell of time or host.
json hashes_of(const fs::path& run) {
  json hashes;
  for (const json& stage : read_json(run / "run.json").at("stages")) {
    for (const json& output : stage.at("outputs")) hashes[stage.at("id")].push_back(output.at("xxh128"));
  }
  return hashes;
}

class Cranium : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    if (std::getenv("PERIOST_CRANIUM") == nullptr) return;
    fs::remove_all(kOut.parent_path());
    run_ = shell(kProgram.string() + " run " PERIOST_SOURCE_DIR "/configs/cranium.yaml --threads 2 --progress none" +
                 " --save isosurface --out " + kOut.string());
  }
  void SetUp() override {
    if (std::getenv("PERIOST_CRANIUM") == nullptr) GTEST_SKIP() << "PERIOST_CRANIUM is not set";
    ASSERT_EQ(run_.exit_code, 0) << run_.output;
  }
  static Finished run_;
};
Finished Cranium::run_;

TEST_F(Cranium, LeavesWhatTheContractSays) {
  for (const char* name : {"run.json", "quality.json", "events.ndjson", "config.yaml", "surface.vtp", "volume.vtu",
                           "surface.stl", "cranium.inp", "isosurface.vtp"}) {
    EXPECT_TRUE(fs::exists(kOut / name)) << name;
  }
  const json run = read_json(kOut / "run.json");
  EXPECT_EQ(run.at("schema"), "periost-run/1");
  EXPECT_EQ(run.at("exit_code"), 0);
  for (const auto& entry : fs::recursive_directory_iterator(kOut)) {
    EXPECT_EQ(entry.path().filename().string().find(".partial"), std::string::npos) << entry.path();
  }
}

TEST_F(Cranium, SurfaceIsClosedManifoldAndWithinItsDistance) {
  const json quality = read_json(kOut / "quality.json");
  const json& isosurface = quality.at("isosurface");
  EXPECT_TRUE(isosurface.at("closed"));
  EXPECT_TRUE(isosurface.at("manifold"));
  EXPECT_NEAR(isosurface.at("triangles").get<double>(), 535000, 5000);
  const json& surface = quality.at("surface");
  EXPECT_TRUE(surface.at("closed"));
  EXPECT_TRUE(surface.at("manifold"));
  EXPECT_TRUE(surface.at("oriented"));
  EXPECT_EQ(surface.at("self_intersections"), 0);
  EXPECT_EQ(surface.at("euler"), isosurface.at("euler"));
  EXPECT_EQ(surface.at("components"), isosurface.at("components"));
  EXPECT_LE(surface.at("distance").at("hausdorff").get<double>(), 0.3 * (1 + 1e-4));
  EXPECT_GE(quality.at("decimation").at("rate").get<double>(), 0.9);
  EXPECT_EQ(quality.at("volume").at("inverted"), 0);
}

TEST_F(Cranium, QualityCommandAgreesWithTheReport) {
  const json report = read_json(kOut / "quality.json");
  const auto measured = [&](const std::string& arguments) {
    const Finished finished = shell(kProgram.string() + " quality " + arguments + " --format json 2>/dev/null");
    return json::parse(finished.output);
  };
  const json surface = measured((kOut / "surface.vtp").string() + " --reference " + (kOut / "isosurface.vtp").string());
  EXPECT_EQ(surface.at("surface").at("triangles"), report.at("surface").at("triangles"));
  EXPECT_EQ(surface.at("surface").at("min_angle_deg"), report.at("surface").at("min_angle_deg"));
  const json volume = measured((kOut / "volume.vtu").string());
  for (const char* metric : {"min_dihedral_deg", "radius_ratio", "scaled_jacobian", "mean_ratio", "aspect_ratio"}) {
    EXPECT_EQ(volume.at("volume").at(metric), report.at("volume").at(metric)) << metric;
  }
}

TEST_F(Cranium, IndependentCheckerAgrees) {
  const char* checker = std::getenv("PERIOST_MESHMETRICS");
  if (checker == nullptr) GTEST_SKIP() << "PERIOST_MESHMETRICS is not set";
  const json report = read_json(kOut / "quality.json");
  const double voxel = report.at("isosurface").at("voxel_mm");
  const Finished finished = shell(std::string(checker) + " --ref " + (kOut / "isosurface.vtp").string() + " --voxel " +
                                  std::to_string(voxel) + " " + (kOut / "surface.vtp").string());
  RecordProperty("meshmetrics", finished.output);
  const json checked = json::parse(finished.output);
  std::cout << checked.dump() << "\n";
}

TEST_F(Cranium, SolverReadsAndSolvesTheDeck) {
  if (shell("command -v ccx").exit_code != 0) GTEST_SKIP() << "CalculiX (ccx) is not installed";
}

TEST_F(Cranium, ThreadsAndResolvedConfigurationGiveTheSameBits) {
  const fs::path again = kOut.parent_path() / "again";
  const Finished finished = shell(kProgram.string() + " run " + (kOut / "config.yaml").string() +
                                  " --threads 1 --progress none --save isosurface --out " + again.string());
  ASSERT_EQ(finished.exit_code, 0) << finished.output;
  EXPECT_EQ(hashes_of(again), hashes_of(kOut));
  EXPECT_EQ(shell("cmp " + (again / "quality.json").string() + " " + (kOut / "quality.json").string()).exit_code, 0);
  EXPECT_EQ(shell("cmp " + (again / "cranium.inp").string() + " " + (kOut / "cranium.inp").string()).exit_code, 0);
}

}  // namespace
