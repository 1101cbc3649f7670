// Volume meshes of other programs. All files hold one mesh: two lop-sided tetrahedra of second order whose
// mid-side nodes lie off the middles, so that a node in a wrong place of its element cannot hide.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <string>

#include "pipeline/base/error.h"
#include "pipeline/base/file.h"
#include "pipeline/base/random.h"
#include "pipeline/geometry/measure_volume.h"
#include "pipeline/geometry/tet_faces.h"
#include "pipeline/io/mesh_read.h"
#include "tests/support/process.h"

namespace periost {
namespace {

using testing::HasSubstr;

// In VTK's order; node numbers in files are 10 + 3 * index.
TetMesh lop_sided(int order) {
  TetMesh mesh;
  mesh.points = {{-7, 2, 100}, {-3, 2, 100}, {-7, 8, 100.5}, {-6, 3, 109}, {0, 9, 108}};
  mesh.tets = {{0, 1, 2, 3}, {1, 4, 2, 3}};
  mesh.region = {4, 9};
  if (order == 2) {
    add_midside_nodes(mesh);
    Random random(3, 0);
    for (std::size_t p = 5; p < mesh.points.size(); ++p) {
      for (std::size_t k = 0; k < 3; ++k) mesh.points[p][k] += 0.25 * random.uniform();
    }
  }
  return mesh;
}

std::uint32_t number(Index point) {
  return 10 + 3 * point;
}

std::vector<Index> nodes_of(const TetMesh& mesh, std::size_t t) {
  std::vector<Index> nodes(mesh.tets[t].begin(), mesh.tets[t].end());
  if (mesh.order() == 2) nodes.insert(nodes.end(), mesh.midside[t].begin(), mesh.midside[t].end());
  return nodes;
}

// Gmsh lists the node on edge 23 before that on edge 13.
std::vector<Index> gmsh_nodes_of(const TetMesh& mesh, std::size_t t) {
  std::vector<Index> nodes = nodes_of(mesh, t);
  if (nodes.size() == 10) std::swap(nodes[8], nodes[9]);
  return nodes;
}

enum class Writing { kText, kLittleEnd, kBigEnd };

// Numbers as text, or as bytes of one order or the other.
class Writer {
 public:
  explicit Writer(Writing writing) : writing_(writing) {}
  void text(const std::string& text) { bytes += text; }
  void integer(std::int64_t value) { put(static_cast<std::int32_t>(value)); }
  void size(std::uint64_t value) { put(value); }
  void decimal(double value) { put(value); }
  void end_line() {
    if (writing_ == Writing::kText) bytes += '\n';
  }
  std::string bytes;

 private:
  template <class T>
  void put(T value) {
    if (writing_ == Writing::kText) {
      bytes += fmt::format("{} ", value);
      return;
    }
    std::string raw(sizeof value, '\0');
    std::memcpy(raw.data(), &value, sizeof value);
    if (writing_ == Writing::kBigEnd) std::reverse(raw.begin(), raw.end());
    bytes += raw;
  }
  Writing writing_;
};

Writer gmsh_start(const char* version, Writing writing) {
  Writer out(writing);
  out.text(fmt::format("$MeshFormat\n{} {} 8\n", version, writing == Writing::kText ? 0 : 1));
  if (writing != Writing::kText) {
    out.integer(1);
    out.text("\n");
  }
  out.text("$EndMeshFormat\n$PhysicalNames\n1\n3 1 \"bone\"\n$EndPhysicalNames\n");
  return out;
}

// A triangle and a point stand beside the tetrahedra, as Gmsh writes them.
std::string gmsh_2(const TetMesh& mesh, Writing writing) {
  Writer out = gmsh_start("2.2", writing);
  out.text(fmt::format("$Nodes\n{}\n", mesh.points.size()));
  for (Index p = 0; p < mesh.points.size(); ++p) {
    out.integer(number(p));
    for (std::size_t k = 0; k < 3; ++k) out.decimal(mesh.points[p][k]);
    out.end_line();
  }
  out.text(fmt::format("\n$EndNodes\n$Elements\n{}\n", mesh.tets.size() + 2));
  const auto element = [&](int id, int type, std::int32_t entity, const std::vector<Index>& nodes) {
    if (writing == Writing::kText) {
      for (const int value : {id, type, 2, 1, entity}) out.integer(value);
    } else {
      for (const int value : {type, 1, 2, id, 1, entity}) out.integer(value);
    }
    for (const Index node : nodes) out.integer(number(node));
    out.end_line();
  };
  element(1, 15, 3, {0});
  element(2, 2, 3, {0, 2, 1});
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    element(static_cast<int>(t) + 3, mesh.order() == 2 ? 11 : 4, mesh.region[t], gmsh_nodes_of(mesh, t));
  }
  out.text("\n$EndElements\n");
  return out.bytes;
}

// Nodes in two blocks, one of them with its parameters on a surface.
std::string gmsh_4(const TetMesh& mesh, Writing writing) {
  Writer out = gmsh_start("4.1", writing);
  const std::size_t count = mesh.points.size();
  out.text("$Nodes\n");
  for (const std::size_t value : {std::size_t{2}, count, std::size_t{10}, std::size_t{10 + 3 * count}})
    out.size(value);
  out.end_line();
  for (const bool is_parametric : {true, false}) {
    const Index first = is_parametric ? 0 : 3, last = is_parametric ? 3 : static_cast<Index>(count);
    out.integer(is_parametric ? 2 : 3);
    out.integer(1);
    out.integer(is_parametric ? 1 : 0);
    out.size(last - first);
    out.end_line();
    for (Index p = first; p < last; ++p) out.size(number(p));
    out.end_line();
    for (Index p = first; p < last; ++p) {
      for (std::size_t k = 0; k < 3; ++k) out.decimal(mesh.points[p][k]);
      if (is_parametric) out.decimal(0.5);
      if (is_parametric) out.decimal(0.25);
      out.end_line();
    }
  }
  out.text("\n$EndNodes\n$Elements\n");
  const std::size_t blocks = 1 + mesh.tets.size();
  for (const std::size_t value : {blocks, blocks, std::size_t{1}, blocks}) out.size(value);
  out.end_line();
  const auto element = [&](int id, int dimension, int entity, int type, const std::vector<Index>& nodes) {
    for (const int value : {dimension, entity, type}) out.integer(value);
    out.size(1);
    out.end_line();
    out.size(static_cast<std::uint64_t>(id));
    for (const Index node : nodes) out.size(number(node));
    out.end_line();
  };
  element(1, 2, 5, 2, {0, 2, 1});
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    element(static_cast<int>(t) + 2, 3, mesh.region[t], mesh.order() == 2 ? 11 : 4, gmsh_nodes_of(mesh, t));
  }
  out.text("\n$EndElements\n");
  return out.bytes;
}

std::string abaqus(const TetMesh& mesh) {
  std::string text = "*Heading\n** Job: bone\n*Part, name=P\n*Node\n";
  for (Index p = 0; p < mesh.points.size(); ++p) {
    text += fmt::format("{}, {}, {}, {}\n", number(p), mesh.points[p].x, mesh.points[p].y, mesh.points[p].z);
  }
  text += "*Element, type=S3, elset=SKIN\n77, 10, 13, 16\n*Elset, elset=SKIN2\n77\n";
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    text += fmt::format("*Element, type={}, elset=REGION_{}\n{}", mesh.order() == 2 ? "C3D10M" : "C3D4",
                        mesh.region[t], t + 1);
    for (const Index node : nodes_of(mesh, t)) text += fmt::format(", {}", number(node));
    text += "\n";
  }
  return text +
         "*End Part\n*Assembly, name=A\n*Instance, name=P-1, part=P\n*End Instance\n"
         "*Node\n10, 0., 0., 0.\n*Nset, nset=REF\n10\n*End Assembly\n";
}

std::string tetgen_node(const TetMesh& mesh, int first) {
  std::string text = fmt::format("# points\n{} 3 1 1\n", mesh.points.size());
  for (Index p = 0; p < mesh.points.size(); ++p) {
    const Vec3& at = mesh.points[p];
    text += fmt::format("  {} {} {} {} 0.5 1\n", p + static_cast<Index>(first), at.x, at.y, at.z);
  }
  return text;
}

// TetGen's columns of mid-side nodes are those of the edges 23, 03, 01, 12, 13, 02.
std::string tetgen_ele(const TetMesh& mesh, int first) {
  std::string text = fmt::format("{} {} 1\n", mesh.tets.size(), mesh.order() == 2 ? 10 : 4);
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    text += fmt::format("{}", t + static_cast<std::size_t>(first));
    for (const Index corner : mesh.tets[t]) text += fmt::format(" {}", corner + static_cast<Index>(first));
    for (const std::size_t k : {5U, 3U, 0U, 1U, 4U, 2U}) {
      if (mesh.order() == 2) text += fmt::format(" {}", mesh.midside[t][k] + static_cast<Index>(first));
    }
    text += fmt::format(" {} # region\n", mesh.region[t]);
  }
  return text + "# Generated by hand\n";
}

std::string vtk_legacy(const TetMesh& mesh) {
  const std::size_t nodes = mesh.order() == 2 ? 10 : 4;
  std::string text =
      fmt::format("# vtk DataFile Version 3.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS {} double\n",
                  mesh.points.size());
  for (const Vec3& p : mesh.points) text += fmt::format("{} {} {}\n", p.x, p.y, p.z);
  text += fmt::format("CELLS {} {}\n", mesh.tets.size(), mesh.tets.size() * (nodes + 1));
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    text += fmt::format("{}", nodes);
    for (const Index node : nodes_of(mesh, t)) text += fmt::format(" {}", node);
    text += "\n";
  }
  text += fmt::format("CELL_TYPES {}\n", mesh.tets.size());
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) text += mesh.order() == 2 ? "24\n" : "10\n";
  text += fmt::format("CELL_DATA {}\nSCALARS region int 1\nLOOKUP_TABLE default\n", mesh.tets.size());
  for (const std::int32_t region : mesh.region) text += fmt::format("{}\n", region);
  return text;
}

// Files of every format by their name; TetGen's needs its nodes beside it.
std::map<std::string, std::string> all_formats(const TetMesh& mesh) {
  return {{"text2.msh", gmsh_2(mesh, Writing::kText)},
          {"little2.msh", gmsh_2(mesh, Writing::kLittleEnd)},
          {"big2.msh", gmsh_2(mesh, Writing::kBigEnd)},
          {"text4.msh", gmsh_4(mesh, Writing::kText)},
          {"little4.msh", gmsh_4(mesh, Writing::kLittleEnd)},
          {"big4.MSH", gmsh_4(mesh, Writing::kBigEnd)},
          {"deck.inp", abaqus(mesh)},
          {"legacy.vtk", vtk_legacy(mesh)},
          {"one.node", tetgen_node(mesh, 1)},
          {"one.ele", tetgen_ele(mesh, 1)},
          {"zero.node", tetgen_node(mesh, 0)},
          {"zero.ele", tetgen_ele(mesh, 0)}};
}

class FormatOfOrder : public testing::TestWithParam<int> {};

TEST_P(FormatOfOrder, EveryNodeOfAnElementComesToItsPlace) {
  const test::TemporaryFolder folder;
  const TetMesh mesh = lop_sided(GetParam());
  const auto files = all_formats(mesh);
  for (const auto& [name, bytes] : files) folder.write(name, bytes);
  for (const auto& file : files) {
    SCOPED_TRACE(file.first);
    const AnyMesh read = read_mesh(folder.path() / file.first);
    ASSERT_TRUE(std::holds_alternative<TetMesh>(read));
    const TetMesh& back = std::get<TetMesh>(read);
    EXPECT_EQ(back.points, mesh.points);
    EXPECT_EQ(back.tets, mesh.tets);
    EXPECT_EQ(back.midside, mesh.midside);
    EXPECT_EQ(back.region, mesh.region);
    EXPECT_EQ(boundary_surface(back).triangles.size(), 6U);
  }
}

INSTANTIATE_TEST_SUITE_P(BothOrders, FormatOfOrder, testing::Values(1, 2));

TEST(MeshFormats, AWrongOrderOfMidsideNodesWouldShow) {
  // What the test above rests on: with two mid-side nodes exchanged the elements are no longer valid.
  TetMesh mesh = lop_sided(2);
  WorstElements worst;
  EXPECT_GT(measure_volume(mesh, {}, worst).jacobian_ratio->min, 0.3);
  for (MidsideNodes& nodes : mesh.midside) std::swap(nodes[4], nodes[5]);
  EXPECT_LT(measure_volume(mesh, {}, worst).jacobian_ratio->min, 0);
}

TEST(MeshFormats, TetgensOwnFileOfSecondOrder) {
  // As TetGen 1.5 wrote it with -pAo2, rounded by nothing: all numbers are whole.
  const test::TemporaryFolder folder;
  folder.write(
      "t.1.node",
      "10  3  0  0\n   1    0  0  0\n   2    4  0  0\n   3    0  8  0\n   4    0  0  16\n   5    2  0  8\n"
      "   6    2  0  0\n   7    0  4  0\n   8    0  4  8\n   9    2  4  0\n  10    0  0  8\n"
      "# Generated by tetgen -pAo2 t.poly \n");
  const auto path = folder.write(
      "t.1.ele", "1  10  1\n    1       1     3     4     2      5     6     7     8     9    10    7\n");
  const TetMesh mesh = std::get<TetMesh>(read_mesh(path));
  ASSERT_EQ(mesh.order(), 2);
  for (std::size_t k = 0; k < 6; ++k) {
    const Index a = mesh.tets[0][static_cast<std::size_t>(kTetEdge[k][0])];
    const Index b = mesh.tets[0][static_cast<std::size_t>(kTetEdge[k][1])];
    EXPECT_EQ(mesh.points[mesh.midside[0][k]], 0.5 * (mesh.points[a] + mesh.points[b])) << k;
  }
  EXPECT_EQ(mesh.region[0], 7);
  WorstElements worst;
  EXPECT_EQ(measure_volume(mesh, {}, worst).inverted, 0U);
}

TEST(MeshFormats, TetgensTetrahedraMayBeTurnedTheOtherWay) {
  const test::TemporaryFolder folder;
  TetMesh turned = lop_sided(2);
  for (std::size_t t = 0; t < turned.tets.size(); ++t) {
    std::swap(turned.tets[t][0], turned.tets[t][1]);
    std::swap(turned.midside[t][1], turned.midside[t][2]);
    std::swap(turned.midside[t][3], turned.midside[t][4]);
  }
  folder.write("a.node", tetgen_node(turned, 0));
  const TetMesh mesh = std::get<TetMesh>(read_mesh(folder.write("a.ele", tetgen_ele(turned, 0))));
  EXPECT_EQ(mesh.tets, lop_sided(2).tets);
  EXPECT_EQ(mesh.midside, lop_sided(2).midside);
  EXPECT_GT(measure_quality({.tet_mesh = &mesh}, {}, {}).report.volume->volume_mm3, 0);
}

TEST(MeshFormats, AMeshOfTrianglesIsASurface) {
  const test::TemporaryFolder folder;
  const auto path =
      folder.write("s.msh",
                   "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 3 1 3\n2 1 0 3\n1\n2\n3\n0 0 0\n1 0 0\n"
                   "0 1 0\n$EndNodes\n$Elements\n1 1 1 1\n2 1 2 1\n1 1 2 3\n$EndElements\n");
  const AnyMesh mesh = read_mesh(path);
  ASSERT_TRUE(std::holds_alternative<SurfaceMesh>(mesh));
  EXPECT_EQ(std::get<SurfaceMesh>(mesh).triangles, (std::vector<Triangle>{{0, 1, 2}}));
  EXPECT_TRUE(std::get<SurfaceMesh>(mesh).was_read);
}

// The error that reading raises, as "code sentence"; empty when it succeeds.
std::string fault_of(const std::filesystem::path& path) {
  try {
    const AnyMesh mesh = read_mesh(path);
    if (const auto* tets = std::get_if<TetMesh>(&mesh)) {
      for (const Vec3& p : tets->points) EXPECT_TRUE(is_finite(p));
      for (const Tetrahedron& tet : tets->tets) {
        for (const Index corner : tet) EXPECT_LT(corner, tets->points.size());
      }
    }
    return {};
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kInput) << error.what();
    EXPECT_NE(error.hint(), "") << error.what();
    return error.code() + " " + error.what();
  }
}

TEST(MeshFormats, FaultsAreOneSentenceWithAPlace) {
  const test::TemporaryFolder folder;
  const std::string format = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
  const std::string nodes = "$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n";
  const std::string table = "4 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n";
  folder.write("ok.node", table);
  folder.write("nan.node", "4 3 0 0\n0 0 0 0\n1 1 0 nan\n2 0 1 0\n3 0 0 1\n");
  folder.write("nan.ele", "1 4 0\n0 0 1 2 3\n");
  folder.write("gap.node", "4 3 0 0\n0 0 0 0\n1 1 0 0\n3 0 1 0\n4 0 0 1\n");
  folder.write("gap.ele", "1 4 0\n0 0 1 2 3\n");
  struct Case {
    const char* name;
    std::string text;
    std::vector<const char*> words;
  };
  const std::vector<Case> cases{
      {"a.stepp", "", {"mesh.unknown_format", "a.stepp"}},
      {"hex.msh",
       format + nodes + "$Elements\n1\n17 5 2 0 1 1 2 3 4 1 2 3 4\n$EndElements\n",
       {"mesh.unsupported", "hex.msh:13", "element 17 is a hexahedron"}},
      {"odd.msh", format + nodes + "$Elements\n1\n1 99 0 1\n$EndElements\n", {"mesh.unsupported", "type 99"}},
      {"old.msh", "$MeshFormat\n4 0 8\n$EndMeshFormat\n", {"mesh.unsupported", "version 4"}},
      {"index.msh",
       format + nodes + "$Elements\n1\n1 4 0 1 2 3 5\n$EndElements\n",
       {"mesh.bad_index", "index.msh:13", "node 5"}},
      {"nan.msh", format + "$Nodes\n1\n1 0 inf 0\n", {"mesh.not_finite", "nan.msh:6", "node 1"}},
      {"twice.msh",
       format + "$Nodes\n2\n1 0 0 0\n1 0 0 0\n",
       {"mesh.malformed", "twice.msh:7", "node 1 is defined twice"}},
      {"count.msh", format + "$Nodes\n18446744073709551615\n1 0 0 0\n", {"mesh.truncated", "count.msh:5"}},
      {"word.msh",
       format + "$Nodes\n2\n1 0 \xff\xfe\x01zero 0\n",
       {"mesh.malformed", "word.msh:6", "'???zero'"}},
      {"more.msh",
       format + "$Nodes\n1\n1 0 0 0\n2 1 0 0\n$EndNodes\n",
       {"mesh.malformed", "more than it announces"}},
      {"none.msh", format + nodes, {"mesh.empty"}},
      {"garbage.msh", std::string("\x89PNG\r\n\x1a\n\0\0\0\rIHDR", 16), {"mesh.malformed"}},
      {"mixed.msh",
       format + nodes + "$Elements\n2\n1 4 0 1 2 3 4\n2 11 0 1 2 3 4 1 1 1 1 1 1\n$EndElements\n",
       {"mesh.unsupported", "mixed"}},
      {"lone.ele", "1 4 0\n0 0 1 2 3\n", {"mesh.missing", "lone.node"}},
      {"ok.ele", "1 4 0\n0 0 1 2 9\n", {"mesh.bad_index", "ok.ele:2", "node 9"}},
      {"nan.ele", "1 4 0\n0 0 1 2 3\n", {"mesh.not_finite", "nan.node:3"}},
      {"gap.ele", "1 4 0\n0 0 1 2 3\n", {"mesh.malformed", "gap.node:4", "node 3 stands where 2 should"}},
      {"ok.ele", "1 8 0\n0 0 1 2 3 0 1 2 3\n", {"mesh.unsupported", "8 nodes"}},
      {"ok.ele", "9999999999 4 0\n0 0 1 2 3\n", {"mesh.truncated", "ok.ele:1"}},
      {"ok.ele", "2 4 0\n0 0 1 2 3\n", {"mesh.truncated", "ok.ele"}},
      {"hex.inp", "*NODE\n1,0,0,0\n*ELEMENT, TYPE=C3D8R\n", {"deck.unsupported", "hex.inp:3", "C3D8R"}},
      {"moved.inp",
       "*Part, name=P\n*End Part\n*Assembly\n*Instance, name=a, part=P\n0., 0., 5.\n",
       {"deck.unsupported", "moved.inp:5"}},
      {"job.inp", "*INCLUDE, INPUT=femur.inp\n", {"deck.unsupported", "includes"}},
      {"hex.vtk",
       "# vtk DataFile Version 3.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 8 float\n5 6 7 1 0 0 1 1 0 0 "
       "1 0\n"
       "0 0 1 1 0 1 1 1 1 0 1 1\nCELLS 1 9\n8 0 1 2 3 4 5 6 7\nCELL_TYPES 1\n12\n",
       {"mesh.unsupported", "cell 0 at (5.00, 6.00, 7.00)", "Hexahedron"}},
      {"huge.vtk",
       "# vtk DataFile Version 3.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 9000000000 float\n0 0 0\n",
       {"mesh.truncated", "POINTS"}},
      {"nan.obj", "v 0 0 0\nv 1 0 nan\nv 0 1 0\nf 1 2 3\n", {"surface.not_finite", "nan.obj:2"}},
      {"index.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", {"surface.bad_index", "index.off:6"}},
  };
  for (const Case& bad : cases) {
    SCOPED_TRACE(bad.name);
    const std::string fault = fault_of(folder.write(bad.name, bad.text));
    for (const char* word : bad.words) EXPECT_THAT(fault, HasSubstr(word));
    EXPECT_THAT(fault, testing::Each(testing::AllOf(testing::Ge(' '), testing::Le('~')))) << "fit to print";
  }
  EXPECT_THAT(fault_of(folder.path() / "absent.msh"), HasSubstr("mesh.missing"));
}

TEST(MeshFormats, NoTruncationAndNoChangedByteDoesHarm) {
  const test::TemporaryFolder folder;
  const auto files = all_formats(lop_sided(2));
  for (const auto& [name, bytes] : files) folder.write(name, bytes);
  Random random(11, 0);
  for (const auto& [name, bytes] : files) {
    SCOPED_TRACE(name);
    // Behind the last element nothing is missed: empty lines, comments, an unused end of a section.
    for (std::size_t keep = 0; keep + 200 < bytes.size(); keep += 41) {
      const std::string fault = fault_of(folder.write(name, bytes.substr(0, keep)));
      // A deck announces nothing, so one that ends between two elements is whole.
      EXPECT_TRUE(!fault.empty() || name == "deck.inp") << keep;
    }
    for (int round = 0; round < 60; ++round) {
      std::string changed = bytes;
      for (int k = 0; k < 3; ++k) {
        const auto at = static_cast<std::size_t>(random.uniform() * static_cast<double>(bytes.size()));
        changed[at] = static_cast<char>(256 * random.uniform());
      }
      fault_of(folder.write(name, changed));
    }
    folder.write(name, bytes);
  }
}

}  // namespace
}  // namespace periost
