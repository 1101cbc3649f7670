#include "pipeline/run/reporter.h"

#include <fcntl.h>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "pipeline/run/clock.h"

namespace periost {
namespace {

constexpr std::array<const char*, 5> kLevelNames{"debug", "info", "warning", "error", "progress"};
constexpr auto kBarPeriod = std::chrono::milliseconds(100);
constexpr auto kPlainPeriod = std::chrono::seconds(10);
constexpr std::size_t kBarCells = 24;

std::string clock_text(double seconds) {
  const auto whole = static_cast<long>(seconds + 0.5);
  return fmt::format("{}:{:02}", whole / 60, whole % 60);
}

// "52 %, 12,300/s, 0:07 left": rate and remaining time once they mean something.
std::string progress_text(const Event& event, double elapsed) {
  const double done = static_cast<double>(event.done);
  std::string text;
  if (event.total > 0) text += fmt::format("{:3.0f} %", 100 * done / static_cast<double>(event.total));
  if (elapsed < 0.2 || event.done == 0) return text;
  const double rate = done / elapsed;
  text += rate >= 10 ? fmt::format(", {:.0f}/s", rate) : fmt::format(", {:.2g}/s", rate);
  if (event.total > event.done) {
    text += fmt::format(", {} left", clock_text(static_cast<double>(event.total - event.done) / rate));
  }
  return text;
}

bool is_terminal() {
  const char* term = std::getenv("TERM");
  return ::isatty(STDERR_FILENO) != 0 && term != nullptr && std::string(term) != "dumb";
}

void write_stderr(const std::string& text) {
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

spdlog::level::level_enum spdlog_level(Event::Level level) {
  switch (level) {
    case Event::Level::kDebug:
      return spdlog::level::debug;
    case Event::Level::kWarning:
      return spdlog::level::warn;
    case Event::Level::kError:
      return spdlog::level::err;
    case Event::Level::kInfo:
    case Event::Level::kProgress:
      return spdlog::level::info;
  }
  return spdlog::level::info;
}

spdlog::logger& logger() {
  // A logger of our own: an embedding program's default logger stays as it is.
  static spdlog::logger instance("periost", std::make_shared<spdlog::sinks::stderr_sink_mt>());
  return instance;
}

}  // namespace

std::string utc_now() {
  const auto now = std::chrono::system_clock::now();
  const auto whole = std::chrono::floor<std::chrono::seconds>(now);
  const auto millis = std::chrono::duration_cast<std::chrono::milliseconds>(now - whole).count();
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}.{:03}Z", fmt::gmtime(std::chrono::system_clock::to_time_t(whole)),
                     millis);
}

std::string event_json(const Event& event, const std::string& time) {
  nlohmann::ordered_json line;
  line["time"] = time;
  line["level"] = kLevelNames[static_cast<std::size_t>(event.level)];
  line["stage"] = event.stage;
  line["code"] = event.code;
  line["text"] = event.text;
  line["progress"] = nullptr;
  if (event.level == Event::Level::kProgress) {
    if (event.total > 0)
      line["progress"] = static_cast<double>(event.done) / static_cast<double>(event.total);
    line["done"] = event.done;
    line["total"] = event.total;
  }
  return line.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

Reporter::Reporter(const ReporterOptions& options) : options_(options) {
  if (options_.progress == ProgressStyle::kAuto) {
    options_.progress = is_terminal() ? ProgressStyle::kBar : ProgressStyle::kPlain;
  }
  if (options_.verbosity == Verbosity::kQuiet) options_.progress = ProgressStyle::kNone;
  logger().set_pattern(options_.log_format == LogFormat::kJson ? "%v" : "%H:%M:%S %l: %v");
  constexpr std::array kLevels{spdlog::level::warn, spdlog::level::info, spdlog::level::debug};
  logger().set_level(kLevels[static_cast<std::size_t>(options_.verbosity)]);
}

Reporter::~Reporter() {
  clear_bar();
  if (events_file_ >= 0) ::close(events_file_);
}

void Reporter::open_events(const std::filesystem::path& path,
                           std::function<std::string(const std::string&)> text_filter) {
  const std::lock_guard lock(mutex_);
  text_filter_ = std::move(text_filter);
  if (events_file_ >= 0) ::close(events_file_);
  events_file_ = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_APPEND, 0666);
}

void Reporter::close_events() {
  const std::lock_guard lock(mutex_);
  if (events_file_ >= 0) ::close(events_file_);
  events_file_ = -1;
  text_filter_ = nullptr;
}

void Reporter::report(const Event& event) {
  const std::lock_guard lock(mutex_);
  const std::string time = utc_now();
  if (events_file_ >= 0) {
    Event filtered = event;
    if (text_filter_) filtered.text = text_filter_(event.text);
    const std::string text = event_json(filtered, time) + "\n";
    [[maybe_unused]] const ssize_t written = ::write(events_file_, text.data(), text.size());
  }
  if (options_.log_format == LogFormat::kJson) {
    if (event.level != Event::Level::kProgress || options_.progress != ProgressStyle::kNone) {
      logger().log(spdlog_level(event.level), "{}", event_json(event, time));
    }
  } else if (event.level == Event::Level::kProgress) {
    show_progress(event);
  } else {
    log(event);
  }
}

void Reporter::log(const Event& event) {
  clear_bar();
  if (event.level == Event::Level::kError) {
    const std::string stage = event.stage.empty() ? std::string() : "stage '" + event.stage + "': ";
    return write_stderr(fmt::format("periost: error: {}{} [{}]\n", stage, event.text, event.code));
  }
  const std::string place = event.stage.empty() ? std::string() : event.stage + ": ";
  const std::string code =
      event.level >= Event::Level::kWarning && !event.code.empty() ? " [" + event.code + "]" : "";
  logger().log(spdlog_level(event.level), "{}{}{}", place, event.text, code);
}

void Reporter::show_progress(const Event& event) {
  if (options_.progress == ProgressStyle::kNone) return;
  const auto now = Clock::now();
  const std::string step = event.stage + ": " + event.text;
  if (step != step_ || event.done == 0) {
    step_ = step;
    step_started_ = last_shown_ = now;
    return;
  }
  const bool is_bar = options_.progress == ProgressStyle::kBar;
  if (is_bar && event.done == event.total) return clear_bar();
  if (now - last_shown_ <
      (is_bar ? std::chrono::milliseconds(kBarPeriod) : std::chrono::milliseconds(kPlainPeriod))) {
    return;
  }
  last_shown_ = now;
  if (is_bar) return draw_bar(event);
  logger().info("{} {}", step_, progress_text(event, seconds_since(step_started_)));
}

void Reporter::draw_bar(const Event& event) {
  const double share =
      event.total > 0 ? static_cast<double>(event.done) / static_cast<double>(event.total) : 0;
  const auto full = std::min(static_cast<std::size_t>(share * static_cast<double>(kBarCells)), kBarCells);
  const std::string bar = std::string(full, '#') + std::string(kBarCells - full, '.');
  write_stderr(
      fmt::format("\r\033[K{} [{}] {}", step_, bar, progress_text(event, seconds_since(step_started_))));
  has_bar_ = true;
}

void Reporter::clear_bar() {
  if (!has_bar_) return;
  write_stderr("\r\033[K");
  has_bar_ = false;
}

}  // namespace periost
