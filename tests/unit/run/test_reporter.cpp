#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "pipeline/base/file.h"
#include "pipeline/run/reporter.h"
#include "tests/support/process.h"

namespace periost::test {
namespace {

using nlohmann::json;

TEST(EventJson, HasTheKeysOfTheContract) {
  const json line =
      json::parse(event_json({Event::Level::kWarning, "tetgen", "tetgen.slow", "a \"long\" one"}, "now"));
  EXPECT_EQ(line["time"], "now");
  EXPECT_EQ(line["level"], "warning");
  EXPECT_EQ(line["stage"], "tetgen");
  EXPECT_EQ(line["code"], "tetgen.slow");
  EXPECT_EQ(line["text"], "a \"long\" one");
  EXPECT_TRUE(line["progress"].is_null());
}

TEST(EventJson, ProgressIsAFraction) {
  EXPECT_EQ(json::parse(event_json({Event::Level::kProgress, "a", "", "b", 1, 4}, ""))["progress"], 0.25);
  EXPECT_TRUE(
      json::parse(event_json({Event::Level::kProgress, "a", "", "b", 1, 0}, ""))["progress"].is_null());
}

TEST(EventJson, BrokenUtf8IsReplacedNotThrown) {
  EXPECT_NO_THROW(event_json({Event::Level::kInfo, "a", "", "\xff\xfe"}, ""));
}

TEST(Reporter, WritesWholeLinesFromManyThreads) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "events.ndjson";
  {
    Reporter reporter({ProgressStyle::kNone, LogFormat::kText, Verbosity::kQuiet});
    reporter.open_events(path);
    std::vector<std::thread> threads;
    for (int t = 0; t < 4; ++t) {
      threads.emplace_back([&reporter] {
        for (int i = 0; i < 50; ++i) reporter.report({Event::Level::kInfo, "s", "c", std::to_string(i)});
      });
    }
    for (std::thread& thread : threads) thread.join();
  }
  std::istringstream lines(read_text(path));
  std::string line;
  int count = 0;
  for (; std::getline(lines, line); ++count) EXPECT_TRUE(json::accept(line)) << line;
  EXPECT_EQ(count, 200);
}

TEST(UtcNow, IsIso8601) {
  EXPECT_THAT(utc_now(),
              testing::MatchesRegex("20[0-9][0-9]-[0-9][0-9]-[0-9][0-9]T[0-9:]+\\.[0-9][0-9][0-9]Z"));
}

}  // namespace
}  // namespace periost::test
