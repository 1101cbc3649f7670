#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/base/error.h"
#include "pipeline/base/file.h"
#include "stages/write_deck/write_deck.h"
#include "tests/support/process.h"

namespace periost {
namespace {

TetMesh one_tetrahedron() {
  TetMesh mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.tets = {{0, 1, 2, 3}};
  mesh.region = {1};
  mesh.boundary = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
  return mesh;
}

TEST(WriteDeck, TheRunNamesTheFiles) {
  const test::TemporaryFolder folder;
  Context context;
  context.output = folder.path();
  context.run_name = "femur";
  WriteDeckOptions options;
  EXPECT_THAT(write_deck(one_tetrahedron(), options, context).files, testing::ElementsAre("femur.inp"));
  options.format = {DeckFormat::kVtu, DeckFormat::kAbaqus};
  options.name = "left";
  EXPECT_THAT(write_deck(one_tetrahedron(), options, context).files,
              testing::ElementsAre("left.inp", "left.vtu"));
  for (const char* name : {"femur.inp", "left.inp", "left.vtu"}) {
    EXPECT_TRUE(std::filesystem::exists(folder.path() / name)) << name;
  }
  EXPECT_EQ(read_text(folder.path() / "femur.inp"), read_text(folder.path() / "left.inp"));
}

TEST(WriteDeck, AnInvertedElementIsRefused) {
  const test::TemporaryFolder folder;
  Context context;
  context.output = folder.path();
  TetMesh mesh = one_tetrahedron();
  std::swap(mesh.tets[0][0], mesh.tets[0][1]);
  try {
    write_deck(mesh, {}, context);
    ADD_FAILURE() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), "deck.inverted");
    EXPECT_THAT(error.what(), testing::HasSubstr("element 1 at (0.25, 0.25, 0.25) mm"));
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(WriteDeck, NamesThatLeaveTheFolderAreNotPlain) {
  EXPECT_TRUE(is_plain_name("femur left"));
  for (const char* name : {"", "..", "../x", "a/b", ".hidden", "a\nb"})
    EXPECT_FALSE(is_plain_name(name)) << name;
}

}  // namespace
}  // namespace periost
