#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "pipeline/base/hash.h"
#include "pipeline/run/resources.h"
#include "pipeline/run/runner.h"
#include "tests/support/process.h"
#include "tests/unit/run/fake_stages.h"

namespace periost::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;

// A chain of fake stages over one input file, run as often as a test wants.
struct RunnerTest : testing::Test {
  TemporaryFolder folder;
  FakeWorld world;
  fs::path input = folder.write("data/input.bin", "123456");
  fs::path out = folder.path() / "out";
  std::string chain = "  - stage: load\n    path: data/input.bin\n  - stage: act\n  - stage: write\n";
  std::string head;
  RunOptions options;
  std::atomic<bool> cancelled{false};
  void SetUp() override {
    options.output = out;
    options.threads = 1;
  }
  std::string messages;  // what diagnostics said

  Manifest run_config(const std::string& text, const fs::path& file) {
    Diagnostics diagnostics;
    const Registry registry = fake_registry(world);
    const Configuration configuration = parse_configuration(text, file, {}, diagnostics);
    const Plan plan = make_plan(configuration, registry, diagnostics);
    for (const Diagnostic& diagnostic : diagnostics) messages += format(diagnostic) + "\n";
    EXPECT_FALSE(has_errors(diagnostics)) << messages;
    Reporter reporter({ProgressStyle::kNone, LogFormat::kText, Verbosity::kQuiet});
    world.runs = 0;
    return run_plan(plan, registry, options, reporter, cancelled);
  }
  Manifest run() {
    return run_config("periost: 1\nname: case\n" + head + "chain:\n" + chain, folder.path() / "case.yaml");
  }
  Manifest resume() {
    options.existing = ExistingFolder::kResume;
    return run();
  }
  json run_json() const { return json::parse(read_text(out / "run.json")); }
};

std::vector<bool> cached(const Manifest& manifest) {
  std::vector<bool> flags;
  for (const StageRecord& stage : manifest.stages) flags.push_back(stage.cached);
  return flags;
}

TEST_F(RunnerTest, LeavesWhatTheContractNames) {
  const Manifest manifest = run();
  EXPECT_EQ(manifest.status, RunStatus::kPassed);
  EXPECT_EQ(manifest.exit_code, 0);
  for (const char* name : {"run.json", "events.ndjson", "config.yaml", "surface.vtp", "case.txt", ".cache"}) {
    EXPECT_TRUE(fs::exists(out / name)) << name;
  }
  EXPECT_FALSE(fs::exists(out / "volume.vtu"));
  EXPECT_TRUE(partial_files(out).empty());
  const json document = run_json();
  EXPECT_EQ(document["status"], "passed");
  EXPECT_EQ(document["inputs"],
            json::parse(R"([{"path": "input.bin", "bytes": 6, "xxh128": ")" + hash_file(input) + "\"}]"));
  ASSERT_EQ(document["stages"].size(), 3u);
  const json& surface = document["stages"][1]["outputs"][0];
  EXPECT_EQ(surface["kind"], "surface");
  EXPECT_EQ(surface["file"], "surface.vtp");
  EXPECT_EQ(surface["xxh128"], hash_file(out / "surface.vtp"));
  EXPECT_EQ(surface["facts"]["triangles"], 6);
  EXPECT_FALSE(document["stages"][0]["outputs"][0].contains("file")) << "only the newest surface is left";
  EXPECT_EQ(document["stages"][2]["outputs"][0]["files"][0]["file"], "case.txt");
  EXPECT_TRUE(document["error"].is_null());
}

TEST_F(RunnerTest, ResumeReusesWhatIsComplete) {
  run();
  EXPECT_EQ(world.runs, 3);
  const Manifest again = resume();
  EXPECT_EQ(world.runs, 0);
  EXPECT_THAT(cached(again), ElementsAre(true, true, true));
  EXPECT_EQ(again.status, RunStatus::kPassed);
  EXPECT_TRUE(fs::exists(out / "case.txt"));
}

TEST_F(RunnerTest, ResumeComputesWhatChanged) {
  run();
  chain = "  - stage: load\n    path: data/input.bin\n  - stage: act\n    factor: 3\n  - stage: write\n";
  EXPECT_THAT(cached(resume()), ElementsAre(true, false, false));
  EXPECT_THAT(read_text(out / "case.txt"), HasSubstr("3.0"));
  folder.write("data/input.bin", "7");
  EXPECT_THAT(cached(resume()), ElementsAre(false, false, false));
}

TEST_F(RunnerTest, TheCacheFollowsContentNotPlace) {
  run();
  folder.write("elsewhere/copy.bin", "123456");
  chain = "  - stage: load\n    path: elsewhere/copy.bin\n  - stage: act\n  - stage: write\n";
  EXPECT_THAT(cached(resume()), ElementsAre(true, true, true));
}

TEST_F(RunnerTest, AMissingDeckIsWrittenAgain) {
  run();
  fs::remove(out / "case.txt");
  EXPECT_THAT(cached(resume()), ElementsAre(true, true, false));
  EXPECT_TRUE(fs::exists(out / "case.txt"));
}

TEST_F(RunnerTest, ResumeDropsFilesThatTheChainNoLongerMakes) {
  run();
  chain = "  - stage: load\n    path: data/input.bin\n";
  resume();
  EXPECT_FALSE(fs::exists(out / "case.txt"));
  EXPECT_TRUE(fs::exists(out / "surface.vtp"));
}

TEST_F(RunnerTest, TheResolvedConfigurationGivesTheSameBitsFromAnywhere) {
  const std::string first = run().stages.at(1).outputs.at(0).xxh128;
  const fs::path moved = folder.write("far/away/config.yaml", read_text(out / "config.yaml"));
  options.output = folder.path() / "second";
  const Manifest manifest = run_config(read_text(moved), moved);
  EXPECT_EQ(manifest.stages.at(1).outputs.at(0).xxh128, first);
  EXPECT_EQ(read_text(options.output / "config.yaml"), read_text(out / "config.yaml"));
}

TEST_F(RunnerTest, AFailedGateEndsTheChain) {
  chain =
      "  - stage: load\n    path: data/input.bin\n  - stage: judge\n    verdict: fail\n  - stage: write\n";
  const Manifest manifest = run();
  EXPECT_EQ(manifest.status, RunStatus::kGateFailed);
  EXPECT_EQ(manifest.exit_code, 3);
  EXPECT_EQ(manifest.stages.size(), 2u);
  EXPECT_FALSE(fs::exists(out / "case.txt"));
  EXPECT_TRUE(fs::exists(out / "surface.vtp"));
  EXPECT_EQ(run_json()["rounds"][0]["verdict"], "fail");
}

TEST_F(RunnerTest, KeepGoingRunsTheRestAndStillFails) {
  chain =
      "  - stage: load\n    path: data/input.bin\n  - stage: judge\n    verdict: fail\n  - stage: write\n";
  options.keep_going = true;
  const Manifest manifest = run();
  EXPECT_EQ(manifest.exit_code, 3);
  EXPECT_EQ(manifest.stages.size(), 3u);
  EXPECT_TRUE(fs::exists(out / "case.txt"));
}

TEST_F(RunnerTest, AWarningPassesWithItsStatus) {
  chain =
      "  - stage: load\n    path: data/input.bin\n  - stage: judge\n    verdict: warn\n  - stage: write\n";
  const Manifest manifest = run();
  EXPECT_EQ(manifest.status, RunStatus::kWarned);
  EXPECT_EQ(manifest.exit_code, 0);
}

struct Failure {
  const char* name;
  std::function<void()> thrown;
  int exit_code;
  const char* code;
};

TEST_F(RunnerTest, EveryFailureHasItsExitCodeAndLeavesWhatWasDone) {
  const std::vector<Failure> failures{
      {"external", [] { throw Error(ErrorKind::kExternal, "tool.died", "it died", "try again"); }, 5,
       "tool.died"},
      {"input", [] { throw Error(ErrorKind::kInput, "image.bad", "it lies"); }, 4, "image.bad"},
      {"memory", [] { throw std::bad_alloc(); }, 6, "limit.memory"},
      {"bug", [] { throw std::logic_error("oops"); }, 1, "internal.unexpected"},
      {"nothing", [] { throw 3; }, 1, "internal.unexpected"},
  };
  options.existing = ExistingFolder::kForce;
  for (const Failure& failure : failures) {
    world.inside = [&failure](Context&) { failure.thrown(); };
    const Manifest manifest = run();
    EXPECT_EQ(manifest.status, RunStatus::kFailed) << failure.name;
    EXPECT_EQ(manifest.exit_code, failure.exit_code) << failure.name;
    const json document = run_json();
    EXPECT_EQ(document["status"], "failed");
    EXPECT_EQ(document["error"]["code"], failure.code);
    EXPECT_EQ(document["error"]["stage"], "act");
    EXPECT_TRUE(fs::exists(out / "surface.vtp")) << "finished before the failure";
    EXPECT_FALSE(fs::exists(out / "case.txt"));
    EXPECT_TRUE(partial_files(out).empty());
  }
}

TEST_F(RunnerTest, AMissingInputIsTheInputsFault) {
  chain = "  - stage: load\n    path: data/missing.bin\n";
  const Manifest manifest = run();
  EXPECT_EQ(manifest.exit_code, 4);
  EXPECT_EQ(manifest.error->stage, "load");
  EXPECT_THAT(manifest.error->text, HasSubstr("missing.bin"));
  EXPECT_THAT(manifest.error->text, testing::Not(HasSubstr(folder.path().string()))) << "folders are private";
}

TEST_F(RunnerTest, CancellationIsAnInterruptionAndCanBeResumed) {
  world.inside = [this](Context& context) {
    cancelled = true;
    context.check_cancelled();
  };
  const Manifest manifest = run();
  EXPECT_EQ(manifest.status, RunStatus::kInterrupted);
  EXPECT_EQ(manifest.exit_code, 130);
  EXPECT_EQ(run_json()["status"], "interrupted");
  cancelled = false;
  world.inside = [](Context&) {};
  EXPECT_THAT(cached(resume()), ElementsAre(true, false, false));
}

TEST_F(RunnerTest, TheGuardEndsAStageThatTakesTooMuchMemory) {
  options.memory_bytes = resident_bytes() + (std::uint64_t{64} << 20);
  world.inside = [](Context& context) {
    std::vector<char> hungry(std::size_t{256} << 20, 'x');
    for (int i = 0; i < 500; ++i) {
      context.check_cancelled();
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    EXPECT_EQ(hungry[0], 'y') << "the guard did not notice";
  };
  const Manifest manifest = run();
  EXPECT_EQ(manifest.exit_code, 6);
  EXPECT_EQ(manifest.error->code, "limit.memory");
}

TEST(CheckMemory, NamesTheLargestStageAndABudgetThatWouldDo) {
  Plan plan;
  plan.steps.resize(2);
  plan.steps[0].id = "small";
  plan.steps[1].id = "large";
  plan.steps[1].peak_bytes = plan.peak_bytes = std::uint64_t{800} << 20;
  EXPECT_NO_THROW(check_memory(plan, 0));
  EXPECT_NO_THROW(check_memory(plan, std::uint64_t{64} << 30));
  try {
    check_memory(plan, 100'000'000);
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kLimit);
    EXPECT_THAT(error.what(), HasSubstr("'large'"));
    EXPECT_THAT(error.hint(), HasSubstr("--memory"));
  }
}

TEST_F(RunnerTest, PathsAppearAsTheConfigurationAllows) {
  head = "provenance: {paths: full}\n";
  run();
  EXPECT_EQ(run_json()["inputs"][0]["path"], input.string());
  head = "provenance: {paths: none}\n";
  options.existing = ExistingFolder::kForce;
  run();
  EXPECT_EQ(run_json()["inputs"][0]["path"], "");
}

TEST_F(RunnerTest, EventsAreWholeLines) {
  run();
  std::istringstream lines(read_text(out / "events.ndjson"));
  int count = 0;
  for (std::string line; std::getline(lines, line); ++count) {
    const json event = json::parse(line);
    for (const char* key : {"time", "level", "stage", "code", "text", "progress"})
      EXPECT_TRUE(event.contains(key));
  }
  EXPECT_GE(count, 3);
}

}  // namespace
}  // namespace periost::test
