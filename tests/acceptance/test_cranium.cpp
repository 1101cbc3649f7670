// The main job on a real CT, seen from outside: what the program left is measured again by the `quality`
// command, by an independent checker, and by a solver. Needs PERIOST_CRANIUM (scripts/fetch_data.sh prints
// it) and, for one test, PERIOST_MESHMETRICS.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "tests/support/golden_facts.h"

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
    run_ = shell(kProgram.string() +
                 " run " PERIOST_SOURCE_DIR "/configs/cranium.yaml --threads 2 --progress none" +
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
  for (const char* name : {"run.json", "quality.json", "events.ndjson", "config.yaml", "surface.vtp",
                           "volume.vtu", "surface.stl", "cranium.inp", "isosurface.vtp"}) {
    EXPECT_TRUE(fs::exists(kOut / name)) << name;
  }
  const json run = read_json(kOut / "run.json");
  EXPECT_EQ(run.at("schema"), "periost-run/1");
  EXPECT_EQ(run.at("exit_code"), 0);
  for (const auto& entry : fs::recursive_directory_iterator(kOut)) {
    EXPECT_EQ(entry.path().filename().string().find(".partial"), std::string::npos) << entry.path();
  }
}

TEST_F(Cranium, KeepsItsGoldenFacts) {
  periost::test::expect_golden_facts("cranium", kOut, run_.exit_code);
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
    const Finished finished =
        shell(kProgram.string() + " quality " + arguments + " --format json 2>/dev/null");
    return json::parse(finished.output);
  };
  const json surface =
      measured((kOut / "surface.vtp").string() + " --reference " + (kOut / "isosurface.vtp").string());
  EXPECT_EQ(surface.at("surface").at("triangles"), report.at("surface").at("triangles"));
  EXPECT_EQ(surface.at("surface").at("min_angle_deg"), report.at("surface").at("min_angle_deg"));
  const json volume = measured((kOut / "volume.vtu").string());
  for (const char* metric :
       {"min_dihedral_deg", "radius_ratio", "scaled_jacobian", "mean_ratio", "aspect_ratio"}) {
    EXPECT_EQ(volume.at("volume").at(metric), report.at("volume").at(metric)) << metric;
  }
}

TEST_F(Cranium, IndependentCheckerAgrees) {
  const char* checker = std::getenv("PERIOST_MESHMETRICS");
  if (checker == nullptr) GTEST_SKIP() << "PERIOST_MESHMETRICS is not set";
  const json report = read_json(kOut / "quality.json");
  const double voxel = report.at("isosurface").at("voxel_mm");
  const auto checked = [&](const char* mesh, const std::string& options) {
    return json::parse(shell(std::string(checker) + " " + options + " " + (kOut / mesh).string()).output);
  };
  // The checker prints six digits. Sampled distances may differ by 2 %.
  const auto near = [](const json& ours, const json& theirs, double relative, const char* what) {
    EXPECT_NEAR(ours.get<double>(), theirs.get<double>(), relative * std::abs(theirs.get<double>())) << what;
  };
  const std::string reference =
      "--ref " + (kOut / "isosurface.vtp").string() + " --voxel " + std::to_string(voxel);
  const json vtp = checked("surface.vtp", reference);
  const json& surface = report.at("surface");
  EXPECT_EQ(vtp.at("surface").at("selfint_pairs"), 0);
  EXPECT_EQ(vtp.at("surface").at("nonmanifold_edges"), 0);
  EXPECT_EQ(vtp.at("surface").at("boundary_edges"), 0);
  EXPECT_EQ(vtp.at("surface").at("euler"), surface.at("euler"));
  near(surface.at("min_angle_deg").at("min"), vtp.at("surface").at("min_angle"), 1e-5, "min_angle");
  near(surface.at("min_angle_deg").at("p01"), vtp.at("surface").at("min_angle_p1"), 1e-3, "min_angle_p1");
  near(surface.at("radius_ratio").at("max"), vtp.at("surface").at("radius_ratio_max"), 1e-5, "radius_ratio");
  near(surface.at("volume_mm3"), vtp.at("surface").at("volume"), 1e-5, "volume");
  const json& distance = surface.at("distance");
  near(distance.at("surface_to_isosurface").at("max"), vtp.at("distance").at("out_to_ref_max"), 0.02,
       "out max");
  near(distance.at("surface_to_isosurface").at("rms"), vtp.at("distance").at("out_to_ref_rms"), 0.02,
       "out rms");
  near(distance.at("isosurface_to_surface").at("max"), vtp.at("distance").at("ref_to_out_max"), 0.02,
       "back max");
  near(distance.at("isosurface_to_surface").at("rms"), vtp.at("distance").at("ref_to_out_rms"), 0.02,
       "back rms");
  EXPECT_LE(vtp.at("distance").at("hausdorff").get<double>(), 0.3 * (1 + 1e-4));

  const json stl = checked("surface.stl", "--no-selfint");
  near(surface.at("min_angle_deg").at("min"), stl.at("surface").at("min_angle"), 1e-4, "STL min_angle");

  const json vtu = checked("volume.vtu", "--no-selfint");
  const json& volume = report.at("volume");
  EXPECT_EQ(vtu.at("tet").at("tets"), volume.at("tets"));
  EXPECT_EQ(vtu.at("tet").at("inverted"), 0);
  near(volume.at("min_dihedral_deg").at("min"), vtu.at("tet").at("min_dihedral"), 1e-5, "min_dihedral");
  near(volume.at("min_dihedral_deg").at("p01"), vtu.at("tet").at("min_dihedral_p1"), 1e-3, "min_dihedral_p1");
  near(volume.at("max_dihedral_deg").at("max"), vtu.at("tet").at("max_dihedral"), 1e-5, "max_dihedral");
  near(volume.at("scaled_jacobian").at("min"), vtu.at("tet").at("scaled_jac_min"), 1e-5, "scaled_jacobian");
  near(volume.at("volume_mm3"), vtu.at("tet").at("volume"), 1e-5, "volume of the tets");
}

// The nodes of a deck that lie outermost along -x, +x, -y and +z: three supports and a place for a load.
std::array<int, 4> outermost_nodes(const fs::path& deck) {
  std::ifstream file(deck);
  std::string line;
  while (std::getline(file, line) && line.rfind("*NODE", 0) != 0) {
  }
  std::array<int, 4> node{};
  std::array<double, 4> reach{-1e300, -1e300, -1e300, -1e300};
  while (std::getline(file, line) && line[0] != '*') {
    int id = 0;
    double x = 0, y = 0, z = 0;
    if (std::sscanf(line.c_str(), "%d , %lf , %lf , %lf", &id, &x, &y, &z) != 4) break;
    const std::array<double, 4> along{-x, x, -y, z};
    for (std::size_t n = 0; n < 4; ++n) {
      if (along[n] > reach[n]) {
        reach[n] = along[n];
        node[n] = id;
      }
    }
  }
  return node;
}

TEST_F(Cranium, SolverReadsAndSolvesTheDeck) {
  if (shell("command -v ccx").exit_code != 0) GTEST_SKIP() << "CalculiX (ccx) is not installed";
  const auto [left, right, back, top] = outermost_nodes(kOut / "cranium.inp");
  ASSERT_GT(top, 0);
  const fs::path folder = kOut.parent_path() / "solved";
  fs::create_directories(folder);
  std::ofstream(folder / "job.inp")
      << "*INCLUDE, INPUT=" << (kOut / "cranium.inp").string() << "\n*NSET, NSET=SUPPORTS\n"
      << left << ", " << right << ", " << back << "\n*MATERIAL, NAME=BONE\n*ELASTIC\n17000., 0.3\n"
      << "*SOLID SECTION, ELSET=EALL, MATERIAL=BONE\n"
      << "*BOUNDARY\nSUPPORTS, 1, 3\n*STEP\n*STATIC\n*CLOAD\n"
      << top << ", 3, -100.\n"
      << "*NODE PRINT, NSET=SUPPORTS, TOTALS=ONLY\nRF\n*NODE PRINT, NSET=NALL\nU\n"
      << "*END STEP\n";
  const Finished solved = shell("cd " + folder.string() + " && ccx -i job");
  EXPECT_EQ(solved.exit_code, 0) << solved.output;
  EXPECT_EQ(solved.output.find("*ERROR"), std::string::npos) << solved.output;
  std::ifstream results(folder / "job.dat");
  std::string line;
  while (std::getline(results, line) && line.find("total force") == std::string::npos) {
  }
  double fx = 1e9, fy = 1e9, fz = 1e9;
  while (std::getline(results, line) && std::sscanf(line.c_str(), "%lf %lf %lf", &fx, &fy, &fz) != 3) {
  }
  EXPECT_NEAR(fx, 0, 1e-2);
  EXPECT_NEAR(fy, 0, 1e-2);
  EXPECT_NEAR(fz, 100, 1e-2);
  double largest = 0;
  while (std::getline(results, line)) {
    int id = 0;
    double x = 0, y = 0, z = 0;
    if (std::sscanf(line.c_str(), "%d %lf %lf %lf", &id, &x, &y, &z) != 4) continue;
    largest = std::max({largest, std::abs(x), std::abs(y), std::abs(z)});
  }
  // A body that is held moves by millimetres at most under 100 N; one that is not held moves by kilometres.
  EXPECT_GT(largest, 0);
  EXPECT_LT(largest, 10);
}

TEST_F(Cranium, ThreadsAndResolvedConfigurationGiveTheSameBits) {
  const fs::path again = kOut.parent_path() / "again";
  const Finished finished = shell(kProgram.string() + " run " + (kOut / "config.yaml").string() +
                                  " --threads 1 --progress none --save isosurface --out " + again.string());
  ASSERT_EQ(finished.exit_code, 0) << finished.output;
  EXPECT_EQ(hashes_of(again), hashes_of(kOut));
  EXPECT_EQ(
      shell("cmp " + (again / "quality.json").string() + " " + (kOut / "quality.json").string()).exit_code,
      0);
  EXPECT_EQ(
      shell("cmp " + (again / "cranium.inp").string() + " " + (kOut / "cranium.inp").string()).exit_code, 0);
}

}  // namespace
