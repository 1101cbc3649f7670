// Every configuration in errors/ beside the exact messages that it must give (NAME.txt). A first line
// `# --set KEY=VALUE` is an override. PERIOST_UPDATE=1 writes the messages anew, to be read before they are
// committed.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>

#include "pipeline/base/file.h"
#include "pipeline/run/plan.h"
#include "tests/support/sample_stages.inl"

namespace periost {
namespace {

const std::filesystem::path kFolder = std::filesystem::path(PERIOST_SOURCE_DIR) / "tests/unit/config/errors";

std::vector<std::string> overrides_of(const std::string& text) {
  static const std::string kStart = "# --set ";
  if (text.rfind(kStart, 0) != 0) return {};
  return {text.substr(kStart.size(), text.find('\n') - kStart.size())};
}

std::string messages_of(const std::filesystem::path& file) {
  Registry registry;
  sample::register_stages(registry);
  Diagnostics diagnostics;
  const std::string text = read_text(file);
  const Configuration configuration =
      parse_configuration(text, file.filename(), overrides_of(text), diagnostics);
  make_plan(configuration, registry, diagnostics);
  std::string messages;
  for (const Diagnostic& diagnostic : diagnostics) messages += format(diagnostic) + "\n";
  return messages;
}

class ConfigurationErrors : public testing::TestWithParam<std::string> {};

TEST_P(ConfigurationErrors, AreTheExpectedSentences) {
  const std::filesystem::path expected = kFolder / (GetParam() + ".txt");
  const std::string messages = messages_of(kFolder / (GetParam() + ".yaml"));
  EXPECT_NE(messages, "") << "this configuration should be refused";
  if (std::getenv("PERIOST_UPDATE") != nullptr) std::ofstream(expected) << messages;
  EXPECT_EQ(messages, read_text(expected));
}

std::vector<std::string> cases() {
  std::vector<std::string> names;
  for (const auto& file : std::filesystem::directory_iterator(kFolder)) {
    if (file.path().extension() == ".yaml") names.push_back(file.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

INSTANTIATE_TEST_SUITE_P(All, ConfigurationErrors, testing::ValuesIn(cases()),
                         [](const auto& test) { return test.param; });

}  // namespace
}  // namespace periost
