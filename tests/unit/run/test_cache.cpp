#include <gtest/gtest.h>

#include <fstream>

#include "pipeline/base/hash.h"
#include "pipeline/run/cache.h"
#include "tests/support/process.h"

namespace periost::test {
namespace {

namespace fs = std::filesystem;

CacheEntry an_entry() {
  SurfaceMesh mesh;
  mesh.points = {{1, 2, 3}};
  CacheEntry entry;
  entry.outputs.emplace_back(std::make_shared<const SurfaceMesh>(mesh));
  entry.outputs.emplace_back(std::make_shared<const Deck>(Deck{{"case.inp"}}));
  return entry;
}

struct CacheTest : testing::Test {
  TemporaryFolder output;
  fs::path folder = output.path() / ".cache";
  Cache cache{folder, output.path()};
  void SetUp() override { fs::create_directories(folder); }
};

TEST_F(CacheTest, AStoredEntryIsFoundWhole) {
  CacheEntry entry = an_entry();
  const fs::path deck = output.write("case.inp", "*NODE");
  entry.files = {{"case.inp", 5, hash_file(deck)}};
  cache.store("k", entry);
  const auto found = cache.find("k");
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->hashes, entry.hashes);
  EXPECT_EQ(found->files, entry.files);
  EXPECT_EQ(kind_of(found->outputs.at(0)), ArtefactKind::kSurface);
  EXPECT_FALSE(cache.find("other").has_value());
}

TEST_F(CacheTest, AChangedOrMissingFileOfADeckMakesItAbsent) {
  CacheEntry entry = an_entry();
  const fs::path deck = output.write("case.inp", "*NODE");
  entry.files = {{"case.inp", 5, hash_file(deck)}};
  cache.store("k", entry);
  output.write("case.inp", "*EDON");
  EXPECT_FALSE(cache.find("k").has_value());
  fs::remove(deck);
  EXPECT_FALSE(cache.find("k").has_value());
}

TEST_F(CacheTest, ADamagedEntryIsAbsent) {
  CacheEntry entry = an_entry();
  cache.store("k", entry);
  const fs::path artefact = folder / (entry.hashes.at(0) + ".artefact");
  fs::resize_file(artefact, fs::file_size(artefact) - 1);
  EXPECT_FALSE(cache.find("k").has_value());
  std::ofstream(folder / "k.json") << "{\"schema\": \"periost-cache/1\", \"outputs\": 3";
  EXPECT_FALSE(cache.find("k").has_value());
  std::ofstream(folder / "k.json") << "{\"schema\": \"periost-cache/1\", \"outputs\": 3, \"files\": []}";
  EXPECT_FALSE(cache.find("k").has_value());
}

TEST_F(CacheTest, KeepOnlyDropsTheOthersAndTheirArtefacts) {
  CacheEntry kept = an_entry();
  cache.store("kept", kept);
  CacheEntry dropped;
  dropped.outputs.emplace_back(std::make_shared<const Deck>(Deck{{"other"}}));
  cache.store("dropped", dropped);
  cache.keep_only({"kept"});
  EXPECT_TRUE(cache.find("kept").has_value());
  EXPECT_FALSE(fs::exists(folder / "dropped.json"));
  EXPECT_FALSE(fs::exists(folder / (dropped.hashes.at(0) + ".artefact")));
}

TEST(StageKey, EveryMemberCounts) {
  const StageKey base{"decimate", 1, "built in", "{distance: 0.3 voxel}", 0, "", {"a", "b"}};
  const std::string hash = hash_of(base);
  EXPECT_EQ(hash.size(), 32u);
  std::vector<StageKey> others(7, base);
  others[0].stage = "decimat";
  others[1].version = 2;
  others[2].origin = "plugin";
  others[3].params = "{distance: 0.4 voxel}";
  others[4].seed = 1;
  others[5].run_name = "case";
  others[6].inputs = {"ab"};
  for (const StageKey& other : others) EXPECT_NE(hash_of(other), hash);
  EXPECT_EQ(hash_of(StageKey(base)), hash);
}

}  // namespace
}  // namespace periost::test
