#pragma once
// Shows a run while it goes: log and progress on standard error, every event as one line of events.ndjson.
#include <chrono>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>

#include "pipeline/base/context.h"

namespace periost {

enum class ProgressStyle { kAuto, kBar, kPlain, kNone };  // auto: a bar on a terminal, else plain
enum class LogFormat { kText, kJson };               // kJson: events on standard error, one object a line
enum class Verbosity { kQuiet, kNormal, kVerbose };  // warnings and errors; plus information; plus details

struct ReporterOptions {
  ProgressStyle progress = ProgressStyle::kAuto;
  LogFormat log_format = LogFormat::kText;
  Verbosity verbosity = Verbosity::kNormal;
};

// One line of events.ndjson, without the line's end: time (UTC), level, stage, code, text, progress (0..1, or
// null when unknown or no progress), and for progress also done and total.
std::string event_json(const Event& event, const std::string& time);
// "2026-11-22T01:05:07.123Z".
std::string utc_now();

// Safe to call from several threads. Losing the events file (a full disk) is not an error of the run.
class Reporter {
 public:
  explicit Reporter(const ReporterOptions& options);
  ~Reporter();
  Reporter(const Reporter&) = delete;
  Reporter& operator=(const Reporter&) = delete;

  // From here on events also go to this file, which starts empty. Each line is written at once, so that a
  // killed run leaves whole lines.
  // `text_filter`, if set, is applied to the texts in the file (paths that must not appear there).
  void open_events(const std::filesystem::path& path,
                   std::function<std::string(const std::string&)> text_filter = {});
  void close_events();
  void report(const Event& event);
  EventSink sink() {
    return [this](const Event& event) { report(event); };
  }

 private:
  void show_progress(const Event& event);
  void draw_bar(const Event& event);
  void clear_bar();
  void log(const Event& event);

  ReporterOptions options_;
  std::mutex mutex_;
  int events_file_ = -1;
  std::function<std::string(const std::string&)> text_filter_;
  bool has_bar_ = false;
  std::string step_;  // what the progress shown last is about
  std::chrono::steady_clock::time_point step_started_;
  std::chrono::steady_clock::time_point last_shown_;
};

}  // namespace periost
