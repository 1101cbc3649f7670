#include "pipeline/run/rounds.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "pipeline/base/hash.h"
#include "pipeline/config/emit.h"
#include "pipeline/run/runner.h"
#include "tests/support/process.h"
#include "tests/unit/run/fake_stages.h"

namespace periost::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::ElementsAre;

RoundScore score_of(std::size_t reached, std::size_t failed, double shortfall, std::size_t warned) {
  RoundScore score;
  score.reached = reached;
  score.failed = failed;
  score.shortfall = shortfall;
  score.warned = warned;
  return score;
}

TEST(Rounds, BetterIsFurtherThenFewerGatesThenNearerThenFewerWarnings) {
  const RoundScore reference = score_of(5, 3, 1.0, 4);
  EXPECT_FALSE(is_better(reference, reference));
  EXPECT_TRUE(is_better(score_of(6, 9, 9, 9), reference));
  EXPECT_TRUE(is_better(score_of(5, 2, 9, 9), reference));
  EXPECT_TRUE(is_better(score_of(5, 3, 0.5, 9), reference));
  EXPECT_TRUE(is_better(score_of(5, 3, 1.0, 3), reference));
  EXPECT_FALSE(is_better(score_of(4, 0, 0, 0), reference));
}

TEST(Rounds, AScoreSumsWhatFailedGatesAreShortOf) {
  QualityReport report;
  report.verdict = Verdict::kFail;
  report.gates = {{"a", ">=", 8.0, {}, 6, Verdict::kFail, {}},
                  {"b", "<=", 0.0, {}, 3, Verdict::kFail, {}},
                  {"c", "<=", 1.0, 0.5, 0.7, Verdict::kWarn, {}}};
  RoundScore score;
  add_report(report, 7, score);
  EXPECT_TRUE(score.has_failed);
  EXPECT_EQ(score.reached, 7u);
  EXPECT_DOUBLE_EQ(score.shortfall, 0.25 + 3);
  EXPECT_EQ(score.warned, 1u);
  EXPECT_THAT(score.failed_metrics, ElementsAre("a", "b"));
}

TEST(Rounds, EveryEndHasItsReason) {
  const auto reason = [](std::uint32_t round, std::uint32_t best, bool passed, bool hints) {
    return reason_to_end(
        {.round = round, .best = best, .max_rounds = 4, .has_passed = passed, .has_new_hints = hints});
  };
  EXPECT_EQ(reason(2, 2, true, false), "pass");
  EXPECT_EQ(reason(4, 4, false, true), "max_rounds");
  EXPECT_EQ(reason(1, 1, false, false), "no_improvement");
  EXPECT_EQ(reason(3, 1, false, true), "no_improvement");
  EXPECT_EQ(reason(2, 1, false, true), "");
}

// load, mend, act, referee, write: the first runs once, the others can be reached by hints.
struct FeedbackTest : testing::Test {
  TemporaryFolder folder;
  FakeWorld world;
  fs::path input = folder.write("input.bin", "123456");
  fs::path out = folder.path() / "out";
  std::atomic<bool> cancelled{false};
  RunOptions options;
  std::string referee = "scores: [3, 2, 0]";
  int max_rounds = 4;

  void SetUp() override {
    options.output = out;
    options.threads = 1;
  }
  std::string text() const {
    return "periost: 1\nname: case\nchain:\n  - stage: load\n    path: input.bin\n  - stage: mend\n"
           "  - stage: act\n  - {stage: referee, " +
           referee +
           "}\n  - stage: write\nfeedback: {until: pass, max_rounds: " + std::to_string(max_rounds) + "}\n";
  }
  Plan plan(const Registry& registry, const std::string& yaml) {
    Diagnostics diagnostics;
    const Configuration configuration =
        parse_configuration(yaml, folder.path() / "case.yaml", {}, diagnostics);
    Plan plan = make_plan(configuration, registry, diagnostics);
    for (const Diagnostic& diagnostic : diagnostics) ADD_FAILURE() << format(diagnostic);
    return plan;
  }
  Manifest run() {
    const Registry registry = fake_registry(world);
    Reporter reporter({ProgressStyle::kNone, LogFormat::kText, Verbosity::kQuiet});
    world.runs = 0;
    return run_plan(plan(registry, text()), registry, options, reporter, cancelled);
  }
  std::string hash(const std::string& name) const { return hash_file(out / name); }
  json run_json() const { return json::parse(read_text(out / "run.json")); }
  std::vector<std::string> verdicts(const Manifest& manifest) const {
    std::vector<std::string> all;
    for (const RoundRecord& round : manifest.rounds) all.push_back(round.verdict);
    return all;
  }
};

TEST_F(FeedbackTest, ThePlanIsUnrolledAndResolvesToItself) {
  const Registry registry = fake_registry(world);
  max_rounds = 2;
  const Plan rounds = plan(registry, text());
  using U = UnrolledStep;
  EXPECT_THAT(unrolled(rounds),
              ElementsAre(U{1, 0}, U{1, 1}, U{1, 2}, U{1, 3}, U{1, 4}, U{2, 1}, U{2, 2}, U{2, 3}, U{2, 4}));
  const std::string resolved = emit_yaml(resolved_configuration(rounds, folder.path()));
  EXPECT_EQ(emit_yaml(resolved_configuration(plan(registry, resolved), folder.path())), resolved);
  EXPECT_NE(resolved.find("max_rounds: 2"), std::string::npos);
}

TEST_F(FeedbackTest, RunsUntilTheGatesPassAndKeepsEveryRound) {
  const Manifest manifest = run();
  EXPECT_EQ(manifest.exit_code, 0);
  EXPECT_EQ(manifest.status, RunStatus::kPassed);
  EXPECT_THAT(verdicts(manifest), ElementsAre("fail", "fail", "pass"));
  EXPECT_EQ(manifest.rounds.back().ended, "pass");
  EXPECT_TRUE(manifest.rounds[2].is_best);
  EXPECT_EQ(world.runs, 1 + 3 * 2 + 1);  // load once, mend and act thrice, write behind the last
  for (const char* name : {"surface.vtp", "quality.json", "hints.json"}) {
    for (const char* round : {"rounds/1/", "rounds/2/", "rounds/3/"}) {
      EXPECT_TRUE(fs::exists(out / round / name)) << round << name;
    }
    EXPECT_EQ(hash(name), hash(std::string("rounds/3/") + name));
  }
  EXPECT_NE(hash("surface.vtp"), hash("rounds/1/surface.vtp"));
  EXPECT_TRUE(fs::exists(out / "case.txt"));
  EXPECT_EQ(read_text(out / "case.txt"), "6.000000");  // (1 + two hints) * 2
  const json document = run_json();
  ASSERT_EQ(document["stages"].size(), 5u);
  EXPECT_EQ(document["stages"][2]["outputs"][0]["xxh128"], hash("surface.vtp"));
  const json& rounds = document["rounds"];
  EXPECT_EQ(rounds[0]["failed_gates"], json::parse(R"(["score"])"));
  EXPECT_EQ(rounds[0]["changed"], json::parse(R"({"mend.times": "0.5"})"));
  EXPECT_EQ(rounds[0]["folder"], "rounds/1");
  EXPECT_EQ(rounds[0]["stages"][1]["outputs"][0]["file"], "rounds/1/surface.vtp");
  EXPECT_EQ(rounds[1]["hints"].size(), 1u);
  EXPECT_EQ(rounds[2]["hints"].size(), 2u);
  const json quality = json::parse(read_text(out / "quality.json"));
  EXPECT_EQ(quality["rounds"].size(), 3u);
  EXPECT_EQ(quality["rounds"][0]["reason"], "too high");
  EXPECT_TRUE(partial_files(out).empty());
}

TEST_F(FeedbackTest, TheBestRoundLiesAtTheTopWhenNoneImproves) {
  referee = "scores: [2, 4, 3, 1]";
  const Manifest manifest = run();
  EXPECT_EQ(manifest.exit_code, 3);
  EXPECT_THAT(verdicts(manifest), ElementsAre("fail", "fail", "fail"));
  EXPECT_TRUE(manifest.rounds[0].is_best);
  EXPECT_EQ(manifest.rounds.back().ended, "no_improvement");
  EXPECT_EQ(hash("surface.vtp"), hash("rounds/1/surface.vtp"));
  EXPECT_NE(hash("surface.vtp"), hash("rounds/3/surface.vtp"));
}

TEST_F(FeedbackTest, ARoundInTheMiddleMayBeBest) {
  referee = "scores: [5, 2, 3, 4]";
  const Manifest manifest = run();
  EXPECT_EQ(manifest.status, RunStatus::kGateFailed);
  EXPECT_EQ(manifest.rounds.back().ended, "max_rounds");
  EXPECT_TRUE(manifest.rounds[1].is_best);
  EXPECT_EQ(hash("surface.vtp"), hash("rounds/2/surface.vtp"));
  EXPECT_EQ(hash("quality.json"), hash("rounds/2/quality.json"));
}

TEST_F(FeedbackTest, WithoutNewHintsThereIsNoSecondRound) {
  referee = "scores: [2, 1], is_silent: true";
  const Manifest manifest = run();
  EXPECT_THAT(verdicts(manifest), ElementsAre("fail"));
  EXPECT_EQ(manifest.rounds[0].ended, "no_improvement");
  EXPECT_FALSE(fs::exists(out / "rounds"));
}

TEST_F(FeedbackTest, OneRoundIsARunWithoutFeedback) {
  max_rounds = 1;
  const Manifest manifest = run();
  EXPECT_EQ(manifest.exit_code, 3);
  EXPECT_EQ(manifest.rounds[0].ended, "max_rounds");
  EXPECT_FALSE(fs::exists(out / "rounds"));
  EXPECT_FALSE(fs::exists(out / "case.txt"));
}

TEST_F(FeedbackTest, WhatNoHintReachesIsNotComputedAgain) {
  referee = "scores: [2, 1, 0], hints_for: somebody";
  const Manifest manifest = run();
  EXPECT_EQ(manifest.rounds.size(), 3u);
  EXPECT_EQ(world.runs, 1 + 2 + 1);
  EXPECT_TRUE(manifest.rounds[1].stages[0].cached);
  EXPECT_EQ(hash("rounds/1/surface.vtp"), hash("surface.vtp"));
}

TEST_F(FeedbackTest, KeepGoingCompletesTheBestRoundOnly) {
  referee = "scores: [2, 4, 3, 1]";
  options.keep_going = true;
  const Manifest manifest = run();
  EXPECT_EQ(manifest.exit_code, 3);
  EXPECT_EQ(read_text(out / "case.txt"), "2.000000");
  EXPECT_FALSE(fs::exists(out / "rounds/2/case.txt"));
  EXPECT_TRUE(fs::exists(out / "rounds/1/case.txt"));
  EXPECT_EQ(manifest.stages.size(), 5u);
  EXPECT_FALSE(manifest.stages[1].cached);
}

TEST_F(FeedbackTest, AnErrorInALaterRoundLeavesTheBestSoFar) {
  world.inside = [this](Context&) {
    if (world.runs > 3) throw Error(ErrorKind::kExternal, "tool.died", "it died");
  };
  const Manifest manifest = run();
  EXPECT_EQ(manifest.exit_code, 3);
  EXPECT_EQ(manifest.status, RunStatus::kGateFailed);
  ASSERT_EQ(manifest.rounds.size(), 2u);
  EXPECT_EQ(manifest.rounds[1].error->code, "tool.died");
  EXPECT_EQ(manifest.rounds[1].ended, "error");
  EXPECT_TRUE(run_json()["rounds"][1]["verdict"].is_null());
  EXPECT_EQ(hash("surface.vtp"), hash("rounds/1/surface.vtp"));
}

TEST_F(FeedbackTest, AnInterruptedLoopKeepsItsRoundsAndCanBeResumed) {
  world.inside = [this](Context&) {
    if (world.runs > 3) cancelled = true;
  };
  const Manifest manifest = run();
  EXPECT_EQ(manifest.status, RunStatus::kInterrupted);
  EXPECT_EQ(manifest.exit_code, 130);
  EXPECT_EQ(manifest.rounds.back().ended, "interrupted");
  EXPECT_EQ(hash("surface.vtp"), hash("rounds/1/surface.vtp"));
  const std::string first = hash("quality.json");
  cancelled = false;
  world.inside = [](Context&) {};
  options.existing = ExistingFolder::kResume;
  const Manifest resumed = run();
  EXPECT_EQ(resumed.exit_code, 0);
  EXPECT_EQ(world.runs, 1 + 2 + 1);  // act of round 2, mend and act of round 3, write
  EXPECT_EQ(hash("rounds/1/quality.json"), first);
  const Manifest again = run();
  EXPECT_EQ(world.runs, 0);
  EXPECT_EQ(again.exit_code, 0);
}

TEST_F(FeedbackTest, ForceAndAShorterLoopRemoveOldRounds) {
  run();
  EXPECT_TRUE(fs::exists(out / "rounds/3/surface.vtp"));
  options.existing = ExistingFolder::kResume;
  max_rounds = 2;
  EXPECT_EQ(run().exit_code, 3);
  EXPECT_FALSE(fs::exists(out / "rounds/3"));
  EXPECT_TRUE(fs::exists(out / "rounds/2/surface.vtp"));
  options.existing = ExistingFolder::kForce;
  referee = "scores: [0]";
  EXPECT_EQ(run().exit_code, 0);
  EXPECT_FALSE(fs::exists(out / "rounds"));
}

}  // namespace
}  // namespace periost::test
