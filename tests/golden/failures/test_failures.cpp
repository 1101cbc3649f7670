// Every way to fail from outside: exit code, one sentence on standard error, run.json where a run began, and
// no half-written file.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/mount.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <nlohmann/json.hpp>
#include <thread>

#include "pipeline/base/file.h"
#include "pipeline/io/image_write.h"
#include "tests/support/process.h"

namespace periost::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

// A ball of 1000 in a void of 0, on an anisotropic grid whose origin is not zero.
Image ball(std::int32_t side) {
  Image image{{{side, side, side}, {0.7, 0.8, 1.1}, {-31, 12, 5}, {}}, {}};
  image.values.resize(image.frame.voxel_count());
  const double middle = 0.5 * (side - 1);
  for (std::int32_t k = 0; k < side; ++k) {
    for (std::int32_t j = 0; j < side; ++j) {
      for (std::int32_t i = 0; i < side; ++i) {
        const double radius = std::hypot(i - middle, j - middle, k - middle);
        image.values[image.frame.offset(i, j, k)] =
            static_cast<float>(1000 / (1 + std::exp(radius - 0.35 * side)));
      }
    }
  }
  return image;
}

constexpr const char* kToIsosurface =
    "periost: 1\nname: case\nchain:\n  - {stage: read_image, path: ball.mha}\n"
    "  - {stage: threshold, lower: 500}\n  - stage: marching_cubes\n";

struct Failures : testing::Test {
  TemporaryFolder folder;
  fs::path out = folder.path() / "out";
  ProcessOptions options;
  std::string program = periost_program();

  ProcessResult run(const std::string& config, std::vector<std::string> more = {}) {
    const fs::path file = folder.write("case.yaml", config);
    std::vector<std::string> arguments{program, "run", file.string(), "--out", out.string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_process(arguments, options);
  }
  void write_ball(std::int32_t side) { write_image(folder.path() / "ball.mha", ball(side)); }

  // Skips the test when a stage that it needs is not part of this program.
  bool lacks(const ProcessResult& result) const {
    return result.err.find("config.unknown_stage") != std::string::npos;
  }

  // One error line with `code` in it, and no half-written file.
  void expect_failure(const ProcessResult& result, int exit_code, const std::string& code) {
    EXPECT_EQ(result.exit_code, exit_code) << result.err;
    EXPECT_THAT(result.err, HasSubstr("[" + code + "]"));
    std::size_t errors = 0;
    for (std::size_t at = result.err.find("error: "); at != std::string::npos;
         at = result.err.find("error: ", at + 1)) {
      ++errors;
    }
    EXPECT_EQ(errors, 1u) << result.err;
    EXPECT_TRUE(partial_files(folder.path()).empty());
  }
  void expect_recorded(const char* status, int exit_code, const std::string& code) {
    ASSERT_TRUE(fs::exists(out / "run.json"));
    const json document = json::parse(read_text(out / "run.json"));
    EXPECT_EQ(document["status"], status);
    EXPECT_EQ(document["exit_code"], exit_code);
    EXPECT_EQ(document["error"]["code"], code);
    EXPECT_NE(document["error"]["text"], "");
  }
  bool waits_for(const fs::path& path) const {
    for (int i = 0; i < 2000 && !fs::exists(path); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    return fs::exists(path);
  }
};

TEST_F(Failures, UnknownStage) {
  expect_failure(run("periost: 1\nchain:\n  - stage: reed_image\n    path: x\n"), 2, "config.unknown_stage");
  EXPECT_FALSE(fs::exists(out));
}

TEST_F(Failures, MisspeltKey) {
  const ProcessResult result =
      run("periost: 1\nchain:\n  - stage: read_image\n    path: a.nii\n    pahts: b.nii\n");
  expect_failure(result, 2, "config.unknown_key");
  EXPECT_THAT(result.err, HasSubstr("case.yaml:5:5: error:"));
  EXPECT_FALSE(fs::exists(out));
}

TEST_F(Failures, UnreadableImage) {
  folder.write("ball.mha", "ObjectType = Image\nNDims = 3\nDimSize = 9999 9999 9999\n");
  const ProcessResult result = run(kToIsosurface);
  EXPECT_EQ(result.exit_code, 4) << result.err;
  if (fs::exists(out)) {
    const json document = json::parse(read_text(out / "run.json"));
    EXPECT_EQ(document["status"], "failed");
  }
  EXPECT_TRUE(partial_files(folder.path()).empty());
}

TEST_F(Failures, ExistingFolder) {
  fs::create_directory(out);
  write_ball(16);
  expect_failure(run(kToIsosurface), 2, "run.folder_exists");
  EXPECT_TRUE(fs::is_empty(out));
}

TEST_F(Failures, MemoryLimit) {
  write_ball(160);
  const ProcessResult result = run(kToIsosurface, {"--memory", "40MB"});
  expect_failure(result, 6, "limit.memory");
  EXPECT_THAT(result.err, HasSubstr("--memory"));
  expect_recorded("failed", 6, "limit.memory");
}

TEST_F(Failures, LimitOnTheSizeOfFiles) {
  write_ball(64);
  options.file_size_limit = 200'000;
  const ProcessResult result = run(kToIsosurface, {"--save", "isosurface"});
  expect_failure(result, 6, "file.disk_full");
  expect_recorded("failed", 6, "file.disk_full");
  EXPECT_FALSE(fs::exists(out / "isosurface.vtp"));
}

TEST_F(Failures, FullDisk) {
  write_ball(64);
  const fs::path disk = folder.path() / "disk";
  fs::create_directory(disk);
  if (::mount("tmpfs", disk.c_str(), "tmpfs", 0, "size=256k") != 0)
    GTEST_SKIP() << "mounting is not allowed here";
  out = disk / "out";
  const ProcessResult result = run(kToIsosurface, {"--save", "isosurface"});
  expect_failure(result, 6, "file.disk_full");
  expect_recorded("failed", 6, "file.disk_full");
  ::umount(disk.c_str());
}

TEST_F(Failures, InterruptedByCtrlC) {
  write_ball(160);
  options.meanwhile = [this](pid_t program_id) {
    EXPECT_TRUE(waits_for(out / "events.ndjson"));
    ::kill(program_id, SIGINT);
  };
  const ProcessResult result = run(kToIsosurface);
  expect_failure(result, 130, "run.interrupted");
  expect_recorded("interrupted", 130, "run.interrupted");
}

TEST_F(Failures, KilledInTheMiddleAndResumed) {
  write_ball(160);
  const auto first_artefact = [this] {
    for (int i = 0; i < 2000; ++i) {
      if (fs::is_directory(out / ".cache")) {
        for (const auto& file : fs::directory_iterator(out / ".cache")) {
          const std::string name = file.path().filename().string();
          if (name.front() != '.' && file.path().extension() == ".json") return true;
        }
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return false;
  };
  options.meanwhile = [&](pid_t program_id) {
    EXPECT_TRUE(first_artefact());
    ::kill(program_id, SIGKILL);
  };
  const ProcessResult killed = run(kToIsosurface);
  EXPECT_EQ(killed.exit_code, 128 + SIGKILL);
  EXPECT_FALSE(fs::exists(out / "run.json"));
  options.meanwhile = nullptr;
  const ProcessResult resumed = run(kToIsosurface, {"--resume"});
  EXPECT_EQ(resumed.exit_code, 0) << resumed.err;
  const json document = json::parse(read_text(out / "run.json"));
  EXPECT_EQ(document["stages"][0]["cached"], true);
  EXPECT_TRUE(partial_files(out).empty());
}

// The whole chain, small.
constexpr const char* kToDeck =
    "periost: 1\nname: case\nchain:\n  - {stage: read_image, path: ball.mha}\n"
    "  - {stage: threshold, lower: 500}\n  - stage: marching_cubes\n  - {stage: decimate, distance: 0.4 "
    "voxel}\n"
    "  - stage: triangulate\n  - {stage: tetgen, order: 2}\n  - {stage: verify, preset: lenient}\n"
    "  - stage: write_deck\n  - {stage: write_surface, format: [stl]}\n";

TEST_F(Failures, NothingDependsOnTheNumberOfThreads) {
  write_ball(24);
  std::vector<json> outputs;
  for (const char* threads : {"1", "2"}) {
    out = folder.path() / threads;
    const ProcessResult result =
        run(kToDeck, {"--threads", threads, "--keep-going", "--save", "image,mask,isosurface,simplex_mesh"});
    ASSERT_TRUE(result.exit_code == 0 || result.exit_code == 3) << result.err;
    json document = json::parse(read_text(out / "run.json"));
    outputs.push_back(json::array());
    for (const json& stage : document["stages"]) outputs.back().push_back(stage["outputs"]);
  }
  EXPECT_EQ(outputs[0], outputs[1]);
  EXPECT_EQ(outputs[0].size(), 9u);
}

// Surfaces that were read, and what is wrong with them.
constexpr const char* kTetrahedron =
    "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";
constexpr const char* kOpen = "OFF\n4 3 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n";
constexpr const char* kNotFinite =
    "OFF\n4 4 0\n0 0 0\n1 0 0\n0 nan 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";
constexpr const char* kCrossing =
    "OFF\n8 8 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n0.1 0.1 0.1\n1.1 0.1 0.1\n0.1 1.1 0.1\n0.1 0.1 1.1\n"
    "3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n3 4 6 5\n3 4 5 7\n3 5 6 7\n3 4 7 6\n";
constexpr const char* kToVolume =
    "periost: 1\nname: case\nchain:\n  - {stage: read_surface, path: mesh.off}\n  - stage: tetgen\n";

struct SurfaceFailures : Failures {
  void expect_refused(const char* mesh, const std::string& word) {
    folder.write("mesh.off", mesh);
    const ProcessResult result = run(kToVolume);
    if (lacks(result)) GTEST_SKIP() << result.err;
    EXPECT_EQ(result.exit_code, 4) << result.err;
    EXPECT_THAT(result.err, HasSubstr(word));
    ASSERT_TRUE(fs::exists(out / "run.json"));
    EXPECT_EQ(json::parse(read_text(out / "run.json"))["status"], "failed");
    EXPECT_FALSE(fs::exists(out / "volume.vtu"));
    EXPECT_TRUE(partial_files(folder.path()).empty());
  }
};

TEST_F(SurfaceFailures, Open) {
  expect_refused(kOpen, "open");
}
TEST_F(SurfaceFailures, NotFinite) {
  expect_refused(kNotFinite, "finite");
}
TEST_F(SurfaceFailures, IntersectingItself) {
  expect_refused(kCrossing, "intersect");
}

TEST_F(Failures, KilledWorker) {
  write_ball(24);
  fs::create_directory(folder.path() / "bin");
  fs::copy_file(periost_program(), folder.path() / "bin" / "periost");
  const fs::path worker = folder.write("bin/periost-tetgen", "#!/bin/sh\nkill -9 $$\n");
  fs::permissions(worker, fs::perms::owner_all);
  program = (folder.path() / "bin" / "periost").string();
  const ProcessResult result = run(kToDeck);
  expect_failure(result, 5, "tetgen.worker_died");
  expect_recorded("failed", 5, "tetgen.worker_died");
  EXPECT_TRUE(fs::exists(out / "surface.vtp")) << "finished before the failure";
  EXPECT_FALSE(fs::exists(out / "volume.vtu"));
}

}  // namespace
}  // namespace periost::test
