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
  registry.add(std::make_unique<WriteStage>(world));
  return registry;
}

}  // namespace periost::test
