#include "stages/write_surface/write_surface.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "tests/support/surfaces.h"

namespace periost {
namespace {

TEST(WriteSurface, LeavesOneFileForEachFormat) {
  Context context;
  context.output = std::filesystem::temp_directory_path() / "periost_write_surface_test";
  std::filesystem::remove_all(context.output);
  WriteSurfaceOptions options;
  options.format = {SurfaceFormat::kStl, SurfaceFormat::kPly, SurfaceFormat::kObj, SurfaceFormat::kVtp};
  options.name = "bone";
  const Deck deck = write_surface_files(test::sphere_surface({1, 2, 3}, 4, 1), options, context);
  EXPECT_EQ(deck.files, (std::vector<std::string>{"bone.stl", "bone.ply", "bone.obj", "bone.vtp"}));
  for (const std::string& file : deck.files)
    EXPECT_GT(std::filesystem::file_size(context.output / file), 1000u);
  std::filesystem::remove_all(context.output);
}

}  // namespace
}  // namespace periost
