#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "pipeline/run/manifest.h"

namespace periost::test {
namespace {

using nlohmann::json;

TEST(Manifest, HasTheKeysOfTheContract) {
  Manifest manifest;
  manifest.name = "cranium";
  manifest.status = RunStatus::kGateFailed;
  manifest.inputs = {{"ct.nii.gz", 12, "abc"}};
  manifest.stages = {
      {"decimate", "decimate", 1, 2, 3, true, {{"surface", "surface.vtp", "def", {{"triangles", 4}}, {}}}}};
  manifest.error = ErrorRecord{"a.b", "decimate", "text", "hint"};
  const json document = json::parse(manifest_json(manifest));
  for (const char* key :
       {"schema", "name", "status", "exit_code", "version", "libraries", "command", "host", "seed", "threads",
        "started", "wall_s", "peak_rss_bytes", "inputs", "stages", "rounds", "error"}) {
    EXPECT_TRUE(document.contains(key)) << key;
  }
  EXPECT_EQ(document["schema"], "periost-run/1");
  EXPECT_EQ(document["status"], "gate_failed");
  EXPECT_GT(document["host"]["memory_bytes"], 0);
  EXPECT_EQ(document["inputs"][0]["path"], "ct.nii.gz");
  EXPECT_EQ(document["stages"][0]["outputs"][0]["facts"]["triangles"], 4);
  EXPECT_EQ(document["error"]["hint"], "hint");
}

TEST(Manifest, PathsAppearAsFarAsAllowed) {
  EXPECT_EQ(provenance_path("/data/smith/ct.nii", Provenance::Paths::kFull), "/data/smith/ct.nii");
  EXPECT_EQ(provenance_path("/data/smith/ct.nii", Provenance::Paths::kBasename), "ct.nii");
  EXPECT_EQ(provenance_path("/data/smith/series/", Provenance::Paths::kBasename), "series");
  EXPECT_EQ(provenance_path("/data/smith/ct.nii", Provenance::Paths::kNone), "");
}

TEST(Manifest, TextsKeepNoMoreOfAPathThanAllowed) {
  const std::string text = "cannot read '/data/smith/ct.nii': it is empty";
  const std::vector<std::filesystem::path> files{"/data/smith/ct.nii"};
  EXPECT_EQ(without_paths(text, files, Provenance::Paths::kFull), text);
  EXPECT_EQ(without_paths(text, files, Provenance::Paths::kBasename), "cannot read 'ct.nii': it is empty");
  EXPECT_EQ(without_paths(text, files, Provenance::Paths::kNone), "cannot read '(input)': it is empty");
}

TEST(Manifest, TheCommandKeepsNoFolders) {
  Manifest manifest;
  manifest.command = {"run", "/home/smith/case.yaml", "--out=/data/smith/out", "--set",
                      "decimate.distance=0.3voxel"};
  const json command = json::parse(manifest_json(manifest))["command"];
  EXPECT_EQ(command,
            json({"periost", "run", "case.yaml", "--out=out", "--set", "decimate.distance=0.3voxel"}));
}

}  // namespace
}  // namespace periost::test
