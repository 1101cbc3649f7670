#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "pipeline/base/error.h"
#include "pipeline/run/run_folder.h"
#include "tests/support/process.h"

namespace periost::test {
namespace {

namespace fs = std::filesystem;

// The code of the error that taking the folder ends in, or "".
std::string refusal(const fs::path& path, ExistingFolder existing) {
  try {
    const RunFolder folder(path, existing);
    return {};
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kUsage);
    return error.code();
  }
}

constexpr const char* kManifest =
    R"({"schema": "periost-run/1", "stages": [{"outputs": [{"kind": "surface", "file": "surface.vtp"},
       {"kind": "deck", "files": [{"file": "case.inp"}, {"file": "../outside.txt"}]}]}]})";

TEST(RunFolder, ANewFolderIsTakenAndRecognised) {
  const TemporaryFolder temporary;
  const fs::path path = temporary.path() / "a" / "b";
  {
    const RunFolder folder(path, ExistingFolder::kRefuse);
    EXPECT_TRUE(fs::is_directory(folder.scratch()));
  }
  EXPECT_TRUE(is_run_folder(path));
  EXPECT_FALSE(fs::exists(path / ".cache" / "scratch"));
}

TEST(RunFolder, AnExistingFolderIsRefusedUnlessAsked) {
  const TemporaryFolder temporary;
  EXPECT_EQ(refusal(temporary.path(), ExistingFolder::kRefuse), "run.folder_exists");
  EXPECT_EQ(refusal(temporary.path(), ExistingFolder::kResume), "");
  EXPECT_EQ(refusal(temporary.path(), ExistingFolder::kForce), "");
}

TEST(RunFolder, AForeignFolderIsNeverTaken) {
  const TemporaryFolder temporary;
  const fs::path letter = temporary.write("letter.txt", "dear all");
  EXPECT_EQ(refusal(temporary.path(), ExistingFolder::kForce), "run.not_a_run_folder");
  EXPECT_EQ(refusal(temporary.path(), ExistingFolder::kResume), "run.not_a_run_folder");
  EXPECT_TRUE(fs::exists(letter));
}

TEST(RunFolder, ForceRemovesOnlyWhatARunLeft) {
  const TemporaryFolder temporary;
  const fs::path run = temporary.path() / "run";
  temporary.write("outside.txt", "not the run's");
  temporary.write("run/run.json", kManifest);
  for (const char* name : {"surface.vtp", "case.inp", "notes.txt", "quality.json", ".cache/x.json"}) {
    temporary.write(std::string("run/") + name, "{}");
  }
  const RunFolder folder(run, ExistingFolder::kForce);
  for (const char* gone : {"run.json", "surface.vtp", "case.inp", "quality.json", ".cache/x.json"}) {
    EXPECT_FALSE(fs::exists(run / gone)) << gone;
  }
  EXPECT_TRUE(fs::exists(run / "notes.txt"));
  EXPECT_TRUE(fs::exists(temporary.path() / "outside.txt"));
}

TEST(RunFolder, ResumeKeepsFilesUntilToldWhichAreStale) {
  const TemporaryFolder temporary;
  const fs::path run = temporary.path() / "run";
  temporary.write("run/run.json", kManifest);
  temporary.write("run/surface.vtp", "");
  temporary.write("run/case.inp", "");
  temporary.write("run/.case.partial.inp", "half");
  const RunFolder folder(run, ExistingFolder::kResume);
  EXPECT_TRUE(partial_files(run).empty());
  EXPECT_FALSE(fs::exists(run / "run.json")) << "the old verdict must not outlive the new start";
  EXPECT_TRUE(fs::exists(run / "surface.vtp"));
  folder.remove_stale({"case.inp"});
  EXPECT_FALSE(fs::exists(run / "surface.vtp"));
  EXPECT_TRUE(fs::exists(run / "case.inp"));
}

TEST(RunFolder, TwoRunsDoNotShareAFolder) {
  const TemporaryFolder temporary;
  const fs::path run = temporary.path() / "run";
  const RunFolder first(run, ExistingFolder::kRefuse);
  EXPECT_EQ(refusal(run, ExistingFolder::kResume), "run.folder_busy");
  EXPECT_EQ(refusal(run, ExistingFolder::kForce), "run.folder_busy");
}

}  // namespace
}  // namespace periost::test
