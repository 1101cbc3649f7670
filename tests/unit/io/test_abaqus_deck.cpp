#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "pipeline/base/error.h"
#include "pipeline/base/file.h"
#include "pipeline/base/random.h"
#include "pipeline/geometry/tet_faces.h"
#include "pipeline/io/abaqus_deck.h"
#include "tests/support/process.h"

namespace periost {
namespace {

// A block of n^3 cubes, each cut into six tetrahedra, sheared and jittered far from the origin.
TetMesh block(int n, int order) {
  TetMesh mesh;
  Random random(5, 0);
  const auto at = [n](int i, int j, int k) { return static_cast<Index>(i + (n + 1) * (j + (n + 1) * k)); };
  for (int k = 0; k <= n; ++k) {
    for (int j = 0; j <= n; ++j) {
      for (int i = 0; i <= n; ++i) {
        mesh.points.push_back({-912.3 + i + 0.2 * j + 0.1 * random.uniform(),
                               1e-7 * random.uniform() + j + 0.1 * k, 1e5 / 3 + k + 0.1 * random.uniform()});
      }
    }
  }
  // The six paths along the axes from one corner of a cube to the opposite one.
  constexpr int kPaths[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {1, 0, 2}, {2, 1, 0}};
  for (int cube = 0; cube < n * n * n; ++cube) {
    const int corner[3] = {cube % n, cube / n % n, cube / (n * n)};
    for (int path = 0; path < 6; ++path) {
      int c[3] = {corner[0], corner[1], corner[2]};
      Tetrahedron tet;
      tet[0] = at(c[0], c[1], c[2]);
      for (std::size_t step = 0; step < 3; ++step) {
        ++c[kPaths[path][step]];
        tet[step + 1] = at(c[0], c[1], c[2]);
      }
      if (path >= 3) std::swap(tet[2], tet[3]);
      mesh.tets.push_back(tet);
      mesh.region.push_back(corner[0] < n / 2 ? 7 : 2);
    }
  }
  for (const BoundaryFace& face : boundary_faces(tet_neighbours(mesh.tets, mesh.points.size()))) {
    mesh.boundary.push_back(face_of(mesh.tets[face.tet], face.opposite));
  }
  if (order == 2) add_midside_nodes(mesh);
  return mesh;
}

class AbaqusDeckOfOrder : public testing::TestWithParam<int> {};

TEST_P(AbaqusDeckOfOrder, ReadsBackWhatWasWritten) {
  const test::TemporaryFolder folder;
  const TetMesh mesh = block(4, GetParam());
  write_abaqus(mesh, folder.path() / "block.inp");
  const AbaqusDeck deck = read_abaqus(folder.path() / "block.inp");
  ASSERT_EQ(deck.mesh.points.size(), mesh.points.size());
  for (std::size_t p = 0; p < mesh.points.size(); ++p) {
    EXPECT_EQ(deck.mesh.points[p].x, mesh.points[p].x);
    EXPECT_NEAR(deck.mesh.points[p].y, mesh.points[p].y, 1e-14 * std::abs(mesh.points[p].y))
        << "20 characters";
    EXPECT_EQ(deck.mesh.points[p].z, mesh.points[p].z);
  }
  // Elements are grouped by region in the file; their sets name them again.
  EXPECT_EQ(deck.mesh.tets.size(), mesh.tets.size());
  EXPECT_EQ(deck.mesh.order(), GetParam());
  std::vector<std::size_t> by_region(mesh.tets.size());
  for (std::size_t t = 0; t < by_region.size(); ++t) by_region[t] = t;
  std::stable_sort(by_region.begin(), by_region.end(),
                   [&](std::size_t a, std::size_t b) { return mesh.region[a] < mesh.region[b]; });
  for (std::size_t t = 0; t < by_region.size(); ++t) {
    EXPECT_EQ(deck.mesh.tets[t], mesh.tets[by_region[t]]);
    EXPECT_EQ(deck.mesh.region[t], mesh.region[by_region[t]]);
    if (GetParam() == 2) {
      EXPECT_EQ(deck.mesh.midside[t], mesh.midside[by_region[t]]);
    }
  }
  EXPECT_EQ(deck.node_sets.at("NALL").size(), mesh.points.size());
  EXPECT_EQ(deck.element_sets.at("EALL").size(), mesh.tets.size());
  EXPECT_EQ(deck.mesh.boundary.size(), mesh.boundary.size());
}

TEST_P(AbaqusDeckOfOrder, SetsOfTheBoundary) {
  const test::TemporaryFolder folder;
  const TetMesh mesh = block(3, GetParam());
  write_abaqus(mesh, folder.path() / "block.inp");
  const AbaqusDeck deck = read_abaqus(folder.path() / "block.inp");
  // Faces as Abaqus numbers them, by corner: S1 1-2-3, S2 1-4-2, S3 2-4-3, S4 3-4-1.
  constexpr std::size_t kFaces[4][3] = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};
  std::vector<Triangle> expected = mesh.boundary, found;
  for (const auto& [tet, face] : deck.surfaces.at("BOUNDARY")) {
    const auto& corner = kFaces[face - 1];
    const Tetrahedron& t = deck.mesh.tets[tet];
    found.push_back({t[corner[0]], t[corner[1]], t[corner[2]]});
  }
  for (auto* triangles : {&expected, &found}) {
    for (Triangle& t : *triangles) std::sort(t.begin(), t.end());
    std::sort(triangles->begin(), triangles->end());
  }
  EXPECT_EQ(found, expected);
  EXPECT_EQ(deck.surfaces.at("OUTER"), deck.surfaces.at("BOUNDARY"));
  EXPECT_FALSE(deck.surfaces.contains("CAVITIES"));
  // A closed surface like a sphere: corners = 2 + triangles / 2, edges = 3 triangles / 2.
  const std::size_t triangles = expected.size();
  EXPECT_EQ(deck.node_sets.at("NBOUNDARY").size(),
            2 + triangles / 2 + (GetParam() == 2 ? 3 * triangles / 2 : 0));
}

TEST_P(AbaqusDeckOfOrder, LinesStayWithinTheLimitsOfCalculix) {
  const test::TemporaryFolder folder;
  write_abaqus(block(3, GetParam()), folder.path() / "block.inp");
  std::istringstream text(read_text(folder.path() / "block.inp"));
  std::string line;
  while (std::getline(text, line)) {
    if (line.substr(0, 1) == "*") continue;
    std::istringstream parts(line);
    std::string part;
    int entries = 0;
    while (std::getline(parts, part, ',')) {
      part.erase(0, part.find_first_not_of(' '));
      EXPECT_LE(part.size(), 20U) << line;
      entries += part.empty() ? 0 : 1;
    }
    EXPECT_LE(entries, 16) << line;
  }
}

INSTANTIATE_TEST_SUITE_P(BothOrders, AbaqusDeckOfOrder, testing::Values(1, 2));

TEST(AbaqusDeck, CavitiesAreASurfaceOfTheirOwn) {
  const test::TemporaryFolder folder;
  TetMesh mesh = block(3, 1);
  // Without the cube in the middle (number 13 of 27).
  mesh.tets.erase(mesh.tets.begin() + 78, mesh.tets.begin() + 84);
  mesh.region.clear();
  write_abaqus(mesh, folder.path() / "hollow.inp");
  const AbaqusDeck deck = read_abaqus(folder.path() / "hollow.inp");
  EXPECT_EQ(deck.surfaces.at("CAVITIES").size(), 12U);
  EXPECT_EQ(deck.surfaces.at("OUTER").size(), 108U);
  EXPECT_EQ(deck.surfaces.at("BOUNDARY").size(), 120U);
  EXPECT_THAT(deck.mesh.region, testing::Each(1));
}

TEST(AbaqusDeck, SameBytesTwiceAndNoDate) {
  const test::TemporaryFolder folder;
  const TetMesh mesh = block(2, 2);
  write_abaqus(mesh, folder.path() / "a.inp");
  write_abaqus(mesh, folder.path() / "b.inp");
  const std::string text = read_text(folder.path() / "a.inp");
  EXPECT_EQ(text, read_text(folder.path() / "b.inp"));
  EXPECT_THAT(text, testing::HasSubstr("mm, N, MPa, tonne"));
  EXPECT_THAT(text, testing::HasSubstr("LPS"));
  EXPECT_THAT(text, testing::Not(testing::HasSubstr("20"
                                                    "26")));
  EXPECT_THAT(test::partial_files(folder.path()), testing::IsEmpty());
}

TEST(AbaqusDeck, ReadsDecksOfOthers) {
  const test::TemporaryFolder folder;
  const auto path = folder.write("other.inp",
                                 "*Heading\n** a comment\n*Node\n10, 0.,0.,0.\n20, 1.0E+00,0.,0.\n"
                                 " 30 ,0., +1.,0.\r\n40,0.,0.,1e0\n50,1,1,1\n"
                                 "*Element, type=c3d4, elset=bone\n5, 10, 20,\n30, 40\n7,20,30,40,50\n"
                                 "*Nset, nset=fixed, generate\n10, 30, 10\n*Elset, elset=all\nbone,\n"
                                 "*Surface, name=top\nbone, s3\n*Material, name=m\n*Elastic\n1000., 0.3\n");
  const AbaqusDeck deck = read_abaqus(path);
  EXPECT_EQ(deck.mesh.tets, (std::vector<Tetrahedron>{{0, 1, 2, 3}, {1, 2, 3, 4}}));
  EXPECT_EQ(deck.node_sets.at("FIXED"), (std::vector<Index>{0, 1, 2}));
  EXPECT_EQ(deck.element_sets.at("ALL"), (std::vector<Index>{0, 1}));
  EXPECT_EQ(deck.surfaces.at("TOP"), (std::vector<DeckFace>{{0, 3}, {1, 3}}));
  EXPECT_EQ(deck.mesh.boundary.size(), 6U);
}

TEST(AbaqusDeck, SaysWhereADeckIsWrong) {
  const test::TemporaryFolder folder;
  const std::string nodes = "*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 0, 1, 0\n4, 0, 0, 1\n";
  const std::vector<std::pair<std::string, std::string>> decks{
      {"*NODE\n1, 0, 0\n", ":2: a node needs"},
      {"*NODE\n1, 0, 0, nan\n", ":2: 'nan'"},
      {nodes + "1, 0, 0, 0\n", ":6: node 1 is defined twice"},
      {nodes + "*ELEMENT, TYPE=C3D8\n", ":6: elements of type C3D8"},
      {nodes + "*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 9\n", ":7: node 9 is not defined"},
      {nodes + "*ELEMENT, TYPE=C3D4\n1, 1, 2, 3\n", "incomplete"},
      {nodes + "*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 4, 1\n", ":7: an element has too many"},
      {nodes, "no C3D4"},
      {nodes + "*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 4\n*SURFACE, NAME=A\n1, S5\n", ":9: a face"},
  };
  for (const auto& [text, words] : decks) {
    const auto path = folder.write("bad.inp", text);
    try {
      read_abaqus(path);
      ADD_FAILURE() << text;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kInput);
      EXPECT_THAT(error.what(), testing::HasSubstr(words));
    }
  }
}

}  // namespace
}  // namespace periost
