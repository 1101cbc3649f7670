// Our solver beside CalculiX on the same mesh, written by our own writer: shape functions, order of the
// mid-side nodes, loads and supports have to agree. Skipped where `ccx` is not installed.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

#include "pipeline/io/abaqus_deck.h"
#include "pipeline/mechanics/solver.h"
#include "tests/support/process.h"
#include "tests/support/tet_meshes.h"

namespace periost {
namespace {

// Where a program lies on the PATH, or empty.
std::string path_of(const std::string& program) {
  const char* path = std::getenv("PATH");
  std::stringstream folders(path != nullptr ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');) {
    const auto file = std::filesystem::path(folder) / program;
    if (std::filesystem::exists(file)) return file.string();
  }
  return {};
}

// Held at one end of x, with uneven displacements; loaded at the other.
LoadCase bending(const TetMesh& mesh, double low, double high) {
  LoadCase load_case;
  for (Index n = 0; n < mesh.points.size(); ++n) {
    const double x = mesh.points[n].x;
    if (x < low + 1e-9) {
      for (int axis = 0; axis < 3; ++axis) load_case.supports.push_back({n, axis, 1e-4 * axis * (n % 3)});
    }
    if (x > high - 1e-9) load_case.loads.push_back({n, {3, -1, 2}});
  }
  return load_case;
}

std::string deck_of(const LoadCase& load_case, const Material& material) {
  std::string deck = "*INCLUDE, INPUT=mesh.inp\n*MATERIAL, NAME=BONE\n*ELASTIC\n";
  deck += fmt::format("{}, {}\n", material.young_mpa, material.poisson);
  deck += "*SOLID SECTION, ELSET=EALL, MATERIAL=BONE\n*STEP\n*STATIC, SOLVER=SPOOLES\n*BOUNDARY\n";
  for (const Support& s : load_case.supports) {
    deck += fmt::format("{}, {}, {}, {}\n", s.node + 1, s.axis + 1, s.axis + 1, s.displacement);
  }
  deck += "*CLOAD\n";
  for (const NodalLoad& load : load_case.loads) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      deck += fmt::format("{}, {}, {}\n", load.node + 1, axis + 1, load.force[axis]);
    }
  }
  return deck + "*NODE PRINT, NSET=NALL\nU\n*END STEP\n";
}

// The table of displacements in a .dat: number and three components a line.
std::vector<Vec3> displacements_in(const std::filesystem::path& path, std::size_t nodes) {
  std::vector<Vec3> result(nodes);
  std::ifstream file(path);
  std::size_t found = 0;
  for (std::string line; std::getline(file, line);) {
    std::istringstream numbers(line);
    std::size_t node = 0;
    Vec3 u;
    if (!(numbers >> node >> u.x >> u.y >> u.z) || node == 0 || node > nodes) continue;
    result[node - 1] = u;
    ++found;
  }
  EXPECT_EQ(found, nodes) << path;
  return result;
}

void compare_with_calculix(int order) {
  const std::string ccx = path_of("ccx");
  if (ccx.empty()) GTEST_SKIP() << "ccx is not installed";
  const test::BoxMeshOptions options{
      .low = {-31, 52, 107}, .cell = {1, 0.8, 1.3}, .cells = {8, 3, 3}, .shake = 0.3, .order = order};
  const TetMesh mesh = test::box_mesh(options);
  const Material material{17000, 0.3};
  const LoadCase load_case = bending(mesh, options.low.x, options.low.x + 8);
  const Solution ours = solve_directly(assemble_stiffness(mesh, material, {}), load_case, {});

  const test::TemporaryFolder folder;
  write_abaqus(mesh, folder.path() / "mesh.inp");
  folder.write("job.inp", deck_of(load_case, material));
  test::ProcessOptions process;
  process.folder = folder.path();
  process.environment["OMP_NUM_THREADS"] = "1";
  const test::ProcessResult run = test::run_process({ccx, "job"}, process);
  ASSERT_EQ(run.exit_code, 0) << run.out;
  const std::vector<Vec3> theirs = displacements_in(folder.path() / "job.dat", mesh.points.size());

  double largest = 0, difference = 0;
  for (std::size_t n = 0; n < theirs.size(); ++n) {
    largest = std::max(largest, norm(theirs[n]));
    difference = std::max(difference, distance(theirs[n], ours.displacement[n]));
  }
  EXPECT_GT(largest, 1e-3);
  EXPECT_LT(difference, 1e-5 * largest);
  ::testing::Test::RecordProperty("difference", fmt::format("{:.3g}", difference / largest));
}

TEST(CalculiX, AgreesAtFirstOrder) {
  compare_with_calculix(1);
}

TEST(CalculiX, AgreesAtSecondOrder) {
  compare_with_calculix(2);
}

}  // namespace
}  // namespace periost
