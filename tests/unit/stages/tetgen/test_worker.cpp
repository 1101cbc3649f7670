#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cstring>
#include <fstream>
#include <thread>

#include "pipeline/base/error.h"
#include "stages/tetgen/tetgen.h"
#include "stages/tetgen/worker_client.h"
#include "tests/support/process.h"
#include "tests/support/surfaces.h"
#include "tests/unit/stages/tetgen/worker_context.h"

namespace periost {
namespace {

using test::worker_context;

std::string worker_program() {
  return (worker_context().workers / "periost-tetgen").string();
}

// Minutes of work for TetGen.
TetgenOptions endless() {
  TetgenOptions options;
  options.max_volume = 1e-5;
  return options;
}

SurfaceMesh small_sphere() {
  return test::sphere_surface({0, 0, 0}, 10, 3);
}

// Our children by /proc: the ids of processes whose parent we are.
std::vector<pid_t> children() {
  std::vector<pid_t> found;
  for (const auto& thread : std::filesystem::directory_iterator("/proc/self/task")) {
    std::ifstream file(thread.path() / "children");
    pid_t pid = 0;
    while (file >> pid) found.push_back(pid);
  }
  return found;
}

void expect_failure(const SurfaceMesh& surface, const TetgenOptions& options, const Context& context,
                    ErrorKind kind, const std::string& code, const std::string& words) {
  try {
    tetrahedralize(surface, options, context);
    ADD_FAILURE() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), kind);
    EXPECT_EQ(error.code(), code);
    EXPECT_THAT(error.what(), testing::HasSubstr(words));
  }
  EXPECT_THAT(children(), testing::IsEmpty()) << "no zombie, no orphan";
}

TEST(TetgenWorker, KilledFromOutside) {
  std::thread killer([] {
    for (int i = 0; i < 1000; ++i) {
      for (const pid_t child : children()) {
        ::kill(child, SIGKILL);
        return;
      }
      ::usleep(10000);
    }
  });
  expect_failure(small_sphere(), endless(), worker_context(), ErrorKind::kExternal, "tetgen.worker_died",
                 "signal 9");
  killer.join();
}

TEST(TetgenWorker, Missing) {
  Context context;
  context.workers = "/nonexistent";
  expect_failure(small_sphere(), {}, context, ErrorKind::kExternal, "tetgen.worker_missing",
                 "/nonexistent/periost-tetgen");
}

TEST(TetgenWorker, AnotherProgramInItsPlaceIsNoWorker) {
  const test::TemporaryFolder folder;
  std::filesystem::create_symlink("/bin/true", folder.path() / "periost-tetgen");
  Context context;
  context.workers = folder.path();
  expect_failure(small_sphere(), {}, context, ErrorKind::kExternal, "tetgen.worker_died", "code 0");
}

TEST(TetgenWorker, TimeLimit) {
  TetgenOptions options = endless();
  options.time_limit = 0.3;
  expect_failure(small_sphere(), options, worker_context(), ErrorKind::kLimit, "tetgen.time", "0.3 s");
}

TEST(TetgenWorker, MemoryLimit) {
#ifdef PERIOST_SANITIZED
  GTEST_SKIP() << "the sanitizers reserve more addresses than any limit";
#else
  Context context = worker_context();
  context.memory_bytes = std::uint64_t{100} << 20;
  expect_failure(small_sphere(), endless(), context, ErrorKind::kLimit, "tetgen.memory", "100");
#endif
}

TEST(TetgenWorker, Cancellation) {
  std::atomic<bool> cancelled = false;
  Context context = worker_context();
  context.cancelled = &cancelled;
  std::thread canceller([&cancelled] {
    for (int i = 0; i < 1000 && children().empty(); ++i) ::usleep(10000);
    cancelled = true;
  });
  expect_failure(small_sphere(), endless(), context, ErrorKind::kInterrupted, "run.interrupted", "");
  canceller.join();
}

TEST(TetgenWorker, TetgensOwnVerdictOnASelfIntersection) {
  WorkerRequest request;
  const SurfaceMesh surface =
      test::joined(test::sphere_surface({0, 0, 0}, 10, 2), test::sphere_surface({9, 1, 0}, 8, 2));
  request.points = surface.points;
  request.triangles = surface.triangles;
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  const WorkerReply reply = run_worker(request, deadline, worker_context());
  EXPECT_EQ(reply.status, periost_tetgen::Status::kSelfIntersection);
  EXPECT_THAT(reply.message, testing::HasSubstr("intersects itself"));
}

TEST(TetgenWorker, AnOpenSurfaceIsNoSilentSuccess) {
  WorkerRequest request;
  SurfaceMesh surface = test::sphere_surface({0, 0, 0}, 10, 2);
  surface.triangles.pop_back();
  request.points = surface.points;
  request.triangles = surface.triangles;
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  EXPECT_EQ(run_worker(request, deadline, worker_context()).status, periost_tetgen::Status::kNothing);
}

TEST(TetgenWorker, ProcessorTimeLimitIsAnswered) {
  WorkerRequest request;
  const SurfaceMesh surface = small_sphere();
  request.points = surface.points;
  request.triangles = surface.triangles;
  request.header.max_volume = 1e-5;
  request.header.cpu_seconds = 1;
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  const WorkerReply reply = run_worker(request, deadline, worker_context());
  EXPECT_EQ(reply.status, periost_tetgen::Status::kTimeLimit);
  EXPECT_THAT(reply.message, testing::HasSubstr("more time"));
}

TEST(TetgenWorker, NonsenseIsRefusedWithASentence) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  WorkerRequest request;
  request.points = small_sphere().points;
  request.triangles = {{0, 1, 99999}};
  WorkerReply reply = run_worker(request, deadline, worker_context());
  EXPECT_EQ(reply.status, periost_tetgen::Status::kBadRequest);
  EXPECT_THAT(reply.message, testing::HasSubstr("does not exist"));
  request.triangles = {{0, 1, 2}};
  request.points[0].x = std::numeric_limits<double>::infinity();
  reply = run_worker(request, deadline, worker_context());
  EXPECT_THAT(reply.message, testing::HasSubstr("finite"));
}

constexpr char kTetrahedron[] =
    "points 4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
    "triangles 4\n0 2 1\n0 1 3\n1 2 3\n2 0 3\n";

TEST(TetgenWorker, RunsByItselfFromFiles) {
  const test::TemporaryFolder folder;
  const auto in = folder.write("in.txt", kTetrahedron);
  const std::string out = (folder.path() / "out.txt").string();
  const auto result = test::run_process({worker_program(), "--in", in.string(), "--out", out});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  std::ifstream file(out);
  std::string text((std::istreambuf_iterator<char>(file)), {});
  EXPECT_THAT(text, testing::HasSubstr("points 4\n"));
  EXPECT_THAT(text, testing::HasSubstr("tetrahedra 1\n"));
}

TEST(TetgenWorker, SaysWhatIsWrongWithFilesAndOptions) {
  const test::TemporaryFolder folder;
  const auto good = folder.write("good.txt", kTetrahedron).string();
  const auto bad = folder.write("bad.txt", "points 4\n0 0 zero\n").string();
  const std::string out = (folder.path() / "out.txt").string();
  const std::vector<std::pair<std::vector<std::string>, std::string>> calls{
      {{"--in", bad, "--out", out}, "points are malformed"},
      {{"--in", "/nonexistent", "--out", out}, "cannot read"},
      {{"--in", good}, "--out"},
      {{"--in", good, "--out", out, "--max-volume", "big"}, "wants a number"},
      {{"--in", good, "--out", out, "--frobnicate", "1"}, "unknown option"},
      {{"--in", good, "--out", "/nonexistent/out.txt"}, "cannot write"},
  };
  for (const auto& [arguments, words] : calls) {
    std::vector<std::string> command{worker_program()};
    command.insert(command.end(), arguments.begin(), arguments.end());
    const auto result = test::run_process(command);
    EXPECT_EQ(result.exit_code, 21);
    EXPECT_THAT(result.err, testing::HasSubstr(words));
  }
  EXPECT_FALSE(std::filesystem::exists(out));
}

}  // namespace
}  // namespace periost
