#pragma once
// What a stage is given besides its data: log, progress, cancellation, seed, threads, memory budget, folders.
// Passed by reference, never global. All members may be called from several threads.
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "pipeline/base/diagnostic.h"

namespace periost {

// One line of the log or one step of progress, as it goes to the terminal and to events.ndjson.
struct Event {
  enum class Level { kDebug, kInfo, kWarning, kError, kProgress };
  Level level = Level::kInfo;
  std::string stage;        // id of the stage that is running
  std::string code;         // dotted word, or empty
  std::string text;         // one sentence; for progress, what is being done
  std::uint64_t done = 0;   // progress only: steps done
  std::uint64_t total = 0;  // progress only: steps in all, 0 if unknown
};

using EventSink = std::function<void(const Event&)>;

class Context;

// A scoped progress counter. `step` may be called from several threads; it forwards about a hundred events in
// all and throws Error{kInterrupted} once the run is cancelled.
class Progress {
 public:
  Progress(const Context& context, std::string_view what, std::uint64_t total);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void step(std::uint64_t count = 1);

 private:
  const Context& context_;
  std::string what_;
  std::uint64_t total_;
  std::uint64_t stride_;
  std::atomic<std::uint64_t> done_{0};
};

class Context {
 public:
  // A quiet context: one thread, seed 0, no limits. Enough for tests and embedding.
  Context() = default;

  EventSink sink;                                // where events go; empty: nowhere
  std::string stage;                             // id put into every event
  std::string name = "mesh";                     // of the run: the base of file names that a stage leaves
  const std::atomic<bool>* cancelled = nullptr;  // set by a signal handler or the embedding program
  std::uint64_t seed = 0;
  int threads = 1;
  std::uint64_t memory_bytes = 0;  // budget; 0: none
  std::string run_name;            // `name` of the configuration, for the names of written files
  std::filesystem::path output;    // folder for files that a stage leaves
  std::filesystem::path scratch;   // folder for files that vanish after the run
  std::filesystem::path workers;   // folder of the worker programs (periost-tetgen)

  void debug(std::string_view code, std::string_view text) const;
  void info(std::string_view code, std::string_view text) const;
  void warn(std::string_view code, std::string_view text) const;

  // Throws Error{kInterrupted} once the run is cancelled. Cheap: one relaxed load.
  void check_cancelled() const;
  bool is_cancelled() const;

 private:
  void emit(Event::Level level, std::string_view code, std::string_view text) const;
};

}  // namespace periost
