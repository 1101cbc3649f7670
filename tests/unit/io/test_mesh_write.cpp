#include <gtest/gtest.h>

#include <filesystem>

#include "pipeline/base/error.h"
#include "pipeline/base/file.h"
#include "pipeline/io/surface_write.h"
#include "pipeline/io/volume_write.h"
#include "tests/support/surfaces.h"

namespace periost {
namespace {

namespace fs = std::filesystem;

class MeshWrite : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / (std::string("periost_mesh_write_") +
                                           testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  fs::path folder_;
};

TEST_F(MeshWrite, EveryFormatGivesTheSameBitsTwiceAndLeavesNothingElse) {
  SurfaceMesh mesh = test::sphere_surface({1.5, -2.25, 300}, 7, 2);
  mesh.point_fields["a field"] = std::vector<float>(mesh.points.size(), 0.5F);
  mesh.voxel_mm = 1.5;
  for (const std::string& format : surface_format_names()) {
    write_surface(mesh, folder_ / ("first." + format));
    write_surface(mesh, folder_ / ("second." + format));
    EXPECT_EQ(read_text(folder_ / ("first." + format)), read_text(folder_ / ("second." + format)));
  }
  std::size_t files = 0;
  for ([[maybe_unused]] const auto& entry : fs::directory_iterator(folder_)) ++files;
  EXPECT_EQ(files, 2 * surface_format_names().size());
}

TEST_F(MeshWrite, AnUnknownExtensionIsAUsageError) {
  try {
    write_surface(test::tetrahedron_surface(), folder_ / "mesh.xyz");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kUsage);
    EXPECT_EQ(error.code(), "surface.unknown_format");
  }
}

TEST_F(MeshWrite, AFullDiskIsALimitAndLeavesNoFile) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
  // The partial name of the target is a link to the device that is always full.
  const fs::path target = folder_ / "mesh.vtp";
  fs::create_symlink("/dev/full", partial_path(target));
  try {
    write_surface(test::tetrahedron_surface(), target);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kLimit);
    EXPECT_EQ(error.code(), "file.disk_full");
  }
  EXPECT_TRUE(fs::is_empty(folder_));
}

}  // namespace
}  // namespace periost
