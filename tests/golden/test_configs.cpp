// Runs every file in configs/ with the built program and compares what came out with a small JSON of facts
// beside this file, each with its own tolerance. `scripts/update-golden.sh` rewrites the values and shows the
// difference.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <regex>
#include <sstream>
#include <string>

#include "tests/support/golden_facts.h"

namespace periost {
namespace {

namespace fs = std::filesystem;

const fs::path kSource = PERIOST_SOURCE_DIR;
const fs::path kProgram = fs::path(PERIOST_BUILD_DIR) / "bin/periost";

// The first environment variable that a configuration needs.
std::string needed_variable(const fs::path& config) {
  std::ifstream file(config);
  std::stringstream text;
  text << file.rdbuf();
  const std::string content = text.str();
  const std::regex variable(R"(\$\{([A-Z_]+)\})");
  std::smatch found;
  return std::regex_search(content, found, variable) ? found[1].str() : std::string();
}

class Golden : public testing::TestWithParam<std::string> {};

TEST_P(Golden, MatchesItsFacts) {
  const fs::path config = kSource / "configs" / (GetParam() + ".yaml");
  if (const std::string name = needed_variable(config); !name.empty()) {
    GTEST_SKIP() << "needs " << name << ": tests/acceptance runs it and keeps its facts";
  }
  const fs::path out = fs::temp_directory_path() / ("periost-golden-" + GetParam());
  fs::remove_all(out);
  const std::string command = kProgram.string() + " run " + config.string() + " --out " + out.string() +
                              " --progress none --quiet > /dev/null 2> " + out.string() + ".log";
  const int status = std::system(command.c_str());
  std::ifstream log(out.string() + ".log");
  std::stringstream said;
  said << log.rdbuf();

  test::expect_golden_facts(GetParam(), out, WEXITSTATUS(status));
  if (HasFailure()) std::cout << said.str();
  fs::remove_all(out);
}

std::vector<std::string> configs() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(kSource / "configs")) {
    if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

INSTANTIATE_TEST_SUITE_P(Configs, Golden, testing::ValuesIn(configs()),
                         [](const auto& parameter) { return parameter.param; });

}  // namespace
}  // namespace periost
