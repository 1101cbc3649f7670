// Decks solved by CalculiX: an independent reader of our elements, sets and units.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <sstream>

#include "pipeline/base/file.h"
#include "pipeline/geometry/tet_faces.h"
#include "stages/tetgen/tetgen.h"
#include "stages/write_deck/write_deck.h"
#include "tests/support/process.h"
#include "tests/support/surfaces.h"

namespace periost {
namespace {

constexpr char kMaterial[] =
    "*MATERIAL, NAME=BONE\n*ELASTIC\n1000., 0.3\n*SOLID SECTION, ELSET=EALL, MATERIAL=BONE\n";

TetMesh meshed(const SurfaceMesh& surface, int order, double max_volume = 0) {
  Context context;
  context.workers = std::filesystem::path(PERIOST_BUILD_DIR) / "bin";
  TetgenOptions options;
  options.order = order;
  options.max_volume = max_volume;
  return tetrahedralize(surface, options, context);
}

// Rows of numbers below the headings of a .dat file, in order.
std::vector<std::vector<std::vector<double>>> tables_of(const std::filesystem::path& path) {
  std::vector<std::vector<std::vector<double>>> tables;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::vector<double> row;
    for (double value = 0; words >> value;) row.push_back(value);
    if (row.empty()) {
      if (line.find_first_not_of(" ") != std::string::npos) tables.emplace_back();
    } else if (!tables.empty()) {
      tables.back().push_back(row);
    }
  }
  return tables;
}

class Calculix : public testing::TestWithParam<int> {
 protected:
  void SetUp() override {
    if (std::system("command -v ccx > /dev/null 2>&1") != 0) GTEST_SKIP() << "ccx is not installed";
  }

  // Writes the mesh as a deck, includes it in another one and solves that.
  std::vector<std::vector<std::vector<double>>> solve(const TetMesh& mesh, const std::string& rest) {
    Context context;
    context.output = folder_.path();
    context.run_name = "part";
    write_deck(mesh, {}, context);
    folder_.write("job.inp", "*INCLUDE, INPUT=part.inp\n" + std::string(kMaterial) + rest);
    test::ProcessOptions options;
    options.folder = folder_.path();
    options.environment["OMP_NUM_THREADS"] = "1";
    const auto result = test::run_process({"/usr/bin/ccx", "job"}, options);
    EXPECT_EQ(result.exit_code, 0) << result.out;
    EXPECT_THAT(result.out, testing::Not(testing::HasSubstr("*ERROR")));
    EXPECT_THAT(result.out, testing::Not(testing::HasSubstr("*WARNING")));
    return tables_of(folder_.path() / "job.dat");
  }

  const test::TemporaryFolder folder_;
};

// With linear displacements on the boundary, every node inside must take the same linear field: it fails for
// second-order elements whose mid-side nodes are in another order.
TEST_P(Calculix, PatchTest) {
  const TetMesh mesh = meshed(test::joined(test::sphere_surface({20, -10, 5}, 10, 2),
                                           test::inverted(test::sphere_surface({20, -10, 5}, 4, 1))),
                              GetParam(), 60);
  const auto field = [](Vec3 p) {
    return Vec3{1e-3 * p.x + 2e-3 * p.y, -1e-3 * p.y + 3e-3 * p.z, 2e-3 * p.z + 1e-3 * p.x};
  };
  const auto faces = boundary_faces(tet_neighbours(mesh.tets, mesh.points.size()));
  std::vector<bool> is_on(mesh.points.size(), false);
  for (const BoundaryFace& face : faces) {
    for (int k = 0; k < 4; ++k) {
      if (k != face.opposite) is_on[mesh.tets[face.tet][static_cast<std::size_t>(k)]] = true;
    }
    for (std::size_t k = 0; k < 6 && mesh.order() == 2; ++k) {
      if (kTetEdge[k][0] != face.opposite && kTetEdge[k][1] != face.opposite) {
        is_on[mesh.midside[face.tet][k]] = true;
      }
    }
  }
  std::ostringstream rest;
  rest.precision(12);
  rest << "*STEP\n*STATIC\n*BOUNDARY\n";
  std::size_t free_nodes = 0;
  for (std::size_t p = 0; p < mesh.points.size(); ++p) {
    free_nodes += is_on[p] ? 0 : 1;
    const Vec3 u = field(mesh.points[p]);
    for (std::size_t k = 0; k < 3 && is_on[p]; ++k) {
      rest << p + 1 << ", " << k + 1 << ", " << k + 1 << ", " << u[k] << "\n";
    }
  }
  rest << "*NODE PRINT, NSET=NALL\nU\n*EL PRINT, ELSET=EALL\nS\n*END STEP\n";
  ASSERT_GT(free_nodes, 5U);
  const auto tables = solve(mesh, rest.str());
  ASSERT_EQ(tables.size(), 2U);
  ASSERT_EQ(tables[0].size(), mesh.points.size());
  for (const auto& row : tables[0]) {
    ASSERT_EQ(row.size(), 4U);
    const Vec3 expected = field(mesh.points[static_cast<std::size_t>(row[0]) - 1]);
    for (std::size_t k = 0; k < 3; ++k) ASSERT_NEAR(row[k + 1], expected[k], 2e-7) << "node " << row[0];
  }
  // One stress everywhere: of the strain exx = 1e-3, eyy = -1e-3, ezz = 2e-3, 2exy = 2e-3, 2exz = 1e-3,
  // 2eyz = 3e-3 with E = 1000 MPa and nu = 0.3.
  const double mu = 1000 / 2.6, lambda = 1000 * 0.3 / (1.3 * 0.4), trace = 2e-3;
  const double stress[6] = {lambda * trace + 2 * mu * 1e-3,
                            lambda * trace - 2 * mu * 1e-3,
                            lambda * trace + 2 * mu * 2e-3,
                            mu * 2e-3,
                            mu * 1e-3,
                            mu * 3e-3};
  ASSERT_GE(tables[1].size(), mesh.tets.size());
  for (const auto& row : tables[1]) {
    ASSERT_EQ(row.size(), 8U);
    for (std::size_t k = 0; k < 6; ++k) ASSERT_NEAR(row[k + 2], stress[k], 2e-5) << "element " << row[0];
  }
}

TEST_P(Calculix, ReactionsBalanceTheLoad) {
  const TetMesh mesh = meshed(test::sphere_surface({0, 0, 100}, 10, 2), GetParam());
  // Three nodes far from each other: one held, one that may slide along a line, one in a plane.
  const auto nearest = [&mesh](Vec3 place) {
    std::size_t best = 0;
    for (std::size_t p = 0; p < 42; ++p) {
      if (distance(mesh.points[p], place) < distance(mesh.points[best], place)) best = p;
    }
    return best + 1;
  };
  const std::size_t held = nearest({-10, 0, 100}), sliding = nearest({10, 0, 100}),
                    resting = nearest({0, 10, 100});
  const std::size_t loaded = nearest({0, 0, 110});
  std::ostringstream rest;
  rest << "*NSET, NSET=SUPPORTS\n"
       << held << ", " << sliding << ", " << resting << "\n"
       << "*BOUNDARY\n"
       << held << ", 1, 3\n"
       << sliding << ", 2, 3\n"
       << resting << ", 3, 3\n"
       << "*STEP\n*STATIC\n*CLOAD\n"
       << loaded << ", 1, 12.5\n"
       << loaded << ", 3, -100.\n"
       << "*NODE PRINT, NSET=SUPPORTS, TOTALS=ONLY\nRF\n*NODE PRINT, NSET=NALL\nU\n*END STEP\n";
  const auto tables = solve(mesh, rest.str());
  ASSERT_EQ(tables.size(), 2U);
  ASSERT_EQ(tables[0].size(), 1U);
  const std::vector<double>& reaction = tables[0][0];
  ASSERT_EQ(reaction.size(), 3U);
  EXPECT_NEAR(reaction[0], -12.5, 1e-5 * 100);
  EXPECT_NEAR(reaction[1], 0, 1e-5 * 100);
  EXPECT_NEAR(reaction[2], 100, 1e-5 * 100);
  ASSERT_EQ(tables[1].size(), mesh.points.size());
  for (const auto& row : tables[1]) {
    for (std::size_t k = 1; k < 4; ++k) ASSERT_LT(std::abs(row[k]), 10) << "node " << row[0];
  }
}

// The same pressure on the surfaces OUTER and CAVITIES of the deck gives one hydrostatic stress, if the faces
// are numbered as CalculiX does and none is missing. The supports only stop rigid motion and carry nothing.
TEST_P(Calculix, PressureOnTheSurfacesIsHydrostatic) {
  const TetMesh mesh = meshed(test::joined(test::sphere_surface({0, 0, 0}, 10, 2),
                                           test::inverted(test::sphere_surface({0, 0, 0}, 5, 1))),
                              GetParam());
  // Nodes 2 and 8 of the icosahedron differ along x, 2 and 5 along y; all three lie in the plane z = 0.
  for (const Index node : {2, 5, 8}) ASSERT_EQ(mesh.points[node - 1].z, 0);
  ASSERT_EQ(mesh.points[8 - 1].y, mesh.points[2 - 1].y);
  ASSERT_EQ(mesh.points[5 - 1].x, mesh.points[2 - 1].x);
  std::ostringstream rest;
  rest << "*BOUNDARY\n2, 1, 3\n8, 2, 3\n5, 3, 3\n"
       << "*STEP\n*STATIC\n*DSLOAD\nOUTER, P, 2.\nCAVITIES, P, 2.\n*EL PRINT, ELSET=EALL\nS\n*END STEP\n";
  const auto tables = solve(mesh, rest.str());
  ASSERT_EQ(tables.size(), 1U);
  ASSERT_GE(tables[0].size(), mesh.tets.size());
  for (const auto& row : tables[0]) {
    for (std::size_t k = 0; k < 6; ++k) ASSERT_NEAR(row[k + 2], k < 3 ? -2.0 : 0.0, 1e-4) << row[0];
  }
}

INSTANTIATE_TEST_SUITE_P(BothOrders, Calculix, testing::Values(1, 2));

}  // namespace
}  // namespace periost
