#include <gtest/gtest.h>

#include <filesystem>

#include "pipeline/base/error.h"
#include "pipeline/base/file.h"
#include "pipeline/io/surface_read.h"
#include "pipeline/io/surface_write.h"
#include "pipeline/io/volume_write.h"
#include "pipeline/io/vtk_mesh_read.h"
#include "tests/support/surfaces.h"

namespace periost {
namespace {

namespace fs = std::filesystem;

class MeshRead : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / (std::string("periost_mesh_read_") +
                                           testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  fs::path write(const std::string& name, const std::string& text) const {
    AtomicFile file(folder_ / name);
    file.write(text);
    file.commit();
    return folder_ / name;
  }
  // The code of the input error that reading raises; empty when it succeeds.
  static std::string code_of(const fs::path& path) {
    try {
      read_surface(path);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kInput) << error.what();
      return error.code();
    }
    return "";
  }
  fs::path folder_;
};

TetMesh two_tets(int order) {
  TetMesh mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1. / 3, 1, 1}};
  mesh.tets = {{0, 1, 2, 3}, {1, 2, 3, 4}};
  mesh.region = {1, 2};
  mesh.boundary = {{0, 2, 1}, {0, 1, 3}};
  mesh.voxel_mm = 0.7;
  mesh.boundary_preserved = false;
  mesh.tet_fields["quality"] = {0.5F, 0.25F};
  if (order == 2) {
    mesh.points.resize(15, {0.1, 0.2, 0.3});
    mesh.midside = {{5, 6, 7, 8, 9, 10}, {6, 11, 12, 13, 14, 5}};
  }
  return mesh;
}

TEST_F(MeshRead, DoublePrecisionFormatsComeBackBitByBit) {
  SurfaceMesh mesh = test::sphere_surface({1.0 / 3, -2e3, 7}, 11, 2);
  mesh.voxel_mm = 1.5;
  mesh.point_fields["height"] = std::vector<float>(mesh.points.size(), 0.25F);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    mesh.triangle_fields["angle"].push_back(static_cast<float>(t) / 3);
  }
  for (const char* format : {"ply", "obj", "off", "vtp"}) {
    const fs::path path = folder_ / (std::string("mesh.") + format);
    write_surface(mesh, path);
    const SurfaceMesh back = read_surface(path);
    EXPECT_EQ(back.points, mesh.points) << format;
    EXPECT_EQ(back.triangles, mesh.triangles) << format;
    EXPECT_TRUE(back.was_read);
    if (std::string(format) == "vtp" || std::string(format) == "ply") {
      EXPECT_EQ(back.point_fields, mesh.point_fields);
      EXPECT_EQ(back.triangle_fields, mesh.triangle_fields);
    }
    if (std::string(format) == "vtp") {
      EXPECT_EQ(back.voxel_mm, 1.5);
    }
  }
}

TEST_F(MeshRead, StlGetsItsConnectivityBack) {
  const SurfaceMesh mesh = test::sphere_surface({5, 6, 7}, 11, 2);
  write_surface(mesh, folder_ / "mesh.stl");
  const SurfaceMesh back = read_surface(folder_ / "mesh.stl");
  EXPECT_EQ(back.points.size(), mesh.points.size());
  ASSERT_EQ(back.triangles.size(), mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_LT(distance(back.points[back.triangles[t][k]], mesh.points[mesh.triangles[t][k]]), 2e-6);
    }
  }
}

TEST_F(MeshRead, TextFormatsByHand) {
  EXPECT_EQ(read_surface(write("a.stl",
                               "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"
                               "vertex 0 1e0 0\nendloop\nendfacet\nendsolid x\n"))
                .triangles.size(),
            1u);
  EXPECT_EQ(
      read_surface(write("b.obj", "# c\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1 -1\n"))
          .triangles.size(),
      2u);
  EXPECT_EQ(read_surface(write("c.ply",
                               "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                               "property float z\nelement face 1\nproperty list uchar int vertex_index\n"
                               "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"))
                .triangles.size(),
            1u);
}

TEST_F(MeshRead, EachTriangleOfAPolygonHasThePolygonsValue) {
  const SurfaceMesh mesh = read_surface(write(
      "q.ply",
      "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 2\nproperty float before\nproperty list uchar int vertex_indices\nproperty uchar after\n"
      "end_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n0.5 4 0 1 2 3 7\n0.25 3 0 1 4 9\n"));
  EXPECT_EQ(mesh.triangles.size(), 3u);
  EXPECT_EQ(mesh.triangle_fields.at("before"), (std::vector<float>{0.5F, 0.5F, 0.25F}));
  EXPECT_EQ(mesh.triangle_fields.at("after"), (std::vector<float>{7, 7, 9}));
}

TEST_F(MeshRead, BrokenFilesAreRefusedWithAPlace) {
  EXPECT_EQ(code_of(folder_ / "absent.stl"), "surface.missing");
  EXPECT_EQ(code_of(write("a.xyz", "1")), "surface.unknown_format");
  EXPECT_EQ(code_of(write("nan.off", "OFF\n3 1 0\n0 0 nan\n1 0 0\n0 1 0\n3 0 1 2\n")), "surface.not_finite");
  EXPECT_EQ(code_of(write("index.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 9\n")), "surface.bad_index");
  EXPECT_EQ(code_of(write("huge.off", "OFF\n4000000000 1 0\n0 0 0\n")), "surface.truncated");
  EXPECT_EQ(code_of(write("empty.obj", "v 0 0 0\n")), "surface.empty");
  EXPECT_EQ(code_of(write("bad.obj", "v 0 0 0\nv 1 x 0\n")), "surface.malformed");
}

TEST_F(MeshRead, EveryTruncationIsAnErrorAndNeverACrash) {
  const SurfaceMesh mesh = test::sphere_surface({5, 6, 7}, 11, 1);
  for (const char* format : {"stl", "ply", "vtp"}) {
    write_surface(mesh, folder_ / (std::string("whole.") + format));
    const std::string bytes = read_text(folder_ / (std::string("whole.") + format));
    // The last bytes of a VTP are its closing tags, which VTK does not miss.
    for (std::size_t keep = 0; keep + 60 < bytes.size(); keep += 97) {
      EXPECT_NE(code_of(write(std::string("part.") + format, bytes.substr(0, keep))), "")
          << format << " " << keep;
    }
  }
}

TEST_F(MeshRead, TetrahedraComeBackBitByBit) {
  for (const int order : {1, 2}) {
    const TetMesh mesh = two_tets(order);
    write_vtu(mesh, folder_ / "mesh.vtu");
    const auto read = read_vtk_mesh(folder_ / "mesh.vtu");
    const TetMesh& back = std::get<TetMesh>(read);
    EXPECT_EQ(back.points, mesh.points);
    EXPECT_EQ(back.tets, mesh.tets);
    EXPECT_EQ(back.midside, mesh.midside);
    EXPECT_EQ(back.region, mesh.region);
    EXPECT_EQ(back.boundary, mesh.boundary);
    EXPECT_EQ(back.tet_fields, mesh.tet_fields);
    EXPECT_EQ(back.voxel_mm, 0.7);
    EXPECT_FALSE(back.boundary_preserved);
  }
}

TEST_F(MeshRead, AVolumeThatNamesAPointThatDoesNotExistIsRefused) {
  TetMesh mesh = two_tets(1);
  mesh.tets[1][3] = 77;
  write_vtu(mesh, folder_ / "mesh.vtu");
  EXPECT_THROW(read_vtk_mesh(folder_ / "mesh.vtu"), Error);
}

}  // namespace
}  // namespace periost
