#pragma once
// Stages that take no time, for tests of the runner.
#include <atomic>
#include <fstream>
#include <functional>

#include "pipeline/base/error.h"
#include "pipeline/base/file.h"
#include "pipeline/stage/registry.h"

namespace periost::test {

// What the fake stages share with the test that runs them.
struct FakeWorld {
  std::atomic<int> runs{0};                                // stages computed, not taken from the cache
  std::function<void(Context&)> inside = [](Context&) {};  // called inside stage `act`
};

struct LoadOptions {
  std::filesystem::path path;
};

// Reads a file and makes a surface of as many triangles as it has bytes.
class LoadStage final : public StageOf<LoadOptions> {
 public:
  explicit LoadStage(FakeWorld& world) : world_(world) {}
  void declare(Declaration<LoadOptions>& d) const override {
    d.stage("load", 1, "Reads.")
        .output<SurfaceMesh>("surface", "What was read.",
                             {.closed = true, .manifold = true, .oriented = true})
        .param("path", &LoadOptions::path, Quantity::kInputPath, Range::any(), "The file.");
  }
  Outputs run(const LoadOptions& options, const Inputs&, Context&) const override {
    ++world_.runs;
    SurfaceMesh mesh;
    mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.triangles.resize(read_text(options.path).size(), Triangle{0, 1, 2});
    return {mesh};
  }

 private:
  FakeWorld& world_;
};

struct ActOptions {
  double factor = 2;
};

// Scales a surface, and does what the test asks meanwhile.
class ActStage final : public StageOf<ActOptions> {
 public:
  explicit ActStage(FakeWorld& world) : world_(world) {}
  void declare(Declaration<ActOptions>& d) const override {
    d.stage("act", 1, "Scales.")
        .input<SurfaceMesh>("surface", "What to scale.")
        .output<SurfaceMesh>("surface", "The scaled one.")
        .param("factor", &ActOptions::factor, Quantity::kNumber, Range::any(), "By how much.");
  }
  Outputs run(const ActOptions& options, const Inputs& inputs, Context& context) const override {
    ++world_.runs;
    world_.inside(context);
    SurfaceMesh mesh = inputs.get<SurfaceMesh>("surface");
    for (Vec3& point : mesh.points) point *= options.factor;
    return {mesh};
  }

 private:
  FakeWorld& world_;
};

struct JudgeOptions {
  std::string verdict = "pass";
};

class JudgeStage final : public StageOf<JudgeOptions> {
 public:
  void declare(Declaration<JudgeOptions>& d) const override {
    d.stage("judge", 1, "Judges.")
        .input<SurfaceMesh>("surface", "What to judge.")
        .output<QualityReport>("quality", "The verdict.")
        .param("verdict", &JudgeOptions::verdict, Quantity::kNone, Range::any(), "The verdict to give.");
  }
  Outputs run(const JudgeOptions& options, const Inputs&, Context&) const override {
    QualityReport report;
    report.verdict = options.verdict == "pass"   ? Verdict::kPass
                     : options.verdict == "warn" ? Verdict::kWarn
                                                 : Verdict::kFail;
    return {report};
  }
};

struct NoOptions {};

// Moves a surface by 1 for every hint.
class MendStage final : public StageOf<NoOptions> {
 public:
  explicit MendStage(FakeWorld& world) : world_(world) {}
  void declare(Declaration<NoOptions>& d) const override {
    d.stage("mend", 1, "Mends.")
        .input<SurfaceMesh>("surface", "What to mend.")
        .optional_input<Hints>("hints", "How often.")
        .output<SurfaceMesh>("surface", "The mended one.");
  }
  Outputs run(const NoOptions&, const Inputs& inputs, Context&) const override {
    ++world_.runs;
    SurfaceMesh mesh = inputs.get<SurfaceMesh>("surface");
    const auto hints = inputs.find<Hints>("hints");
    for (Vec3& point : mesh.points) point.x += hints ? static_cast<double>(hints->hints.size()) : 0;
    return {mesh};
  }

 private:
  FakeWorld& world_;
};

struct RefereeOptions {
  std::vector<double> scores{0};  // of rounds 1, 2, ...; a gate asks for 0
  std::string hints_for = "mend";
  bool is_silent = false;
};

// Judges round by round as it is told, and hints.
class RefereeStage final : public StageOf<RefereeOptions> {
 public:
  void declare(Declaration<RefereeOptions>& d) const override {
    d.stage("referee", 1, "Judges rounds.")
        .input<SurfaceMesh>("surface", "What to judge.")
        .optional_input<Hints>("hints", "Those of the rounds before.")
        .output<QualityReport>("quality", "The verdict.")
        .output<Hints>("hints", "What to mend.")
        .param("scores", &RefereeOptions::scores, Quantity::kNumber, Range::any(), "The gate's values.")
        .param("hints_for", &RefereeOptions::hints_for, Quantity::kNone, Range::any(), "A kind of stage.")
        .param("is_silent", &RefereeOptions::is_silent, Quantity::kNone, Range::any(), "Gives no hints.");
  }
  Outputs run(const RefereeOptions& options, const Inputs& inputs, Context&) const override {
    const auto given = inputs.find<Hints>("hints");
    Hints hints = given ? *given : Hints{};
    const auto round = static_cast<std::uint32_t>(hints.rounds.size() + 1);
    const double score = options.scores.at(round - 1);
    QualityReport report;
    report.verdict = score > 0 ? Verdict::kFail : Verdict::kPass;
    report.gates.push_back({"score", "<=", 0.0, {}, score, report.verdict, {}});
    RoundNote note{round, report.verdict, {}, {}};
    if (score > 0 && !options.is_silent) {
      hints.hints.push_back({options.hints_for, "times", 0.5, {}, "score", score, 0, round, "too high"});
      note.changed = {{options.hints_for + ".times", "0.5"}};
      note.reason = "too high";
    }
    hints.rounds.push_back(note);
    report.rounds = hints.rounds;
    return {report, hints};
  }
};

// Writes NAME.txt.
class WriteStage final : public StageOf<NoOptions> {
 public:
  explicit WriteStage(FakeWorld& world) : world_(world) {}
  void declare(Declaration<NoOptions>& d) const override {
    d.stage("write", 1, "Writes.")
        .input<SurfaceMesh>("surface", "What to write.")
        .output<Deck>("deck", "The file.");
  }
  Outputs run(const NoOptions&, const Inputs& inputs, Context& context) const override {
    ++world_.runs;
    AtomicFile file(context.output / (context.run_name + ".txt"));
    file.write(std::to_string(inputs.get<SurfaceMesh>("surface").points[1].x));
    file.commit();
    return {Deck{{context.run_name + ".txt"}}};
  }

 private:
  FakeWorld& world_;
};

inline Registry fake_registry(FakeWorld& world) {
  Registry registry;
  registry.add(std::make_unique<LoadStage>(world));
  registry.add(std::make_unique<ActStage>(world));
  registry.add(std::make_unique<JudgeStage>());
  registry.add(std::make_unique<MendStage>(world));
  registry.add(std::make_unique<RefereeStage>());
  registry.add(std::make_unique<WriteStage>(world));
  return registry;
}

}  // namespace periost::test
