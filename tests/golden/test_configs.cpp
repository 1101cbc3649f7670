// Runs every file in configs/ with the built program and compares what came out with a small JSON of facts
// beside this file, each with its own tolerance. `scripts/update-golden.sh` rewrites the values and shows the
// difference.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>
#include <string>

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const fs::path kSource = PERIOST_SOURCE_DIR;
const fs::path kProgram = fs::path(PERIOST_BUILD_DIR) / "bin/periost";

json read_json(const fs::path& path) {
  std::ifstream file(path);
  return file ? json::parse(file) : json();
}

// Environment variables that a configuration needs and that are not set.
std::string missing_variable(const fs::path& config) {
  std::ifstream file(config);
  std::stringstream text;
  text << file.rdbuf();
  const std::string content = text.str();
  const std::regex variable(R"(\$\{([A-Z_]+)\})");
  for (std::sregex_iterator it(content.begin(), content.end(), variable), end; it != end; ++it) {
    const std::string name = (*it)[1];
    if (std::getenv(name.c_str()) == nullptr) return name;
  }
  return {};
}

class Golden : public testing::TestWithParam<std::string> {};

TEST_P(Golden, MatchesItsFacts) {
  const fs::path config = kSource / "configs" / (GetParam() + ".yaml");
  const fs::path facts_file = kSource / "tests/golden" / (GetParam() + ".json");
  if (const std::string name = missing_variable(config); !name.empty()) {
    GTEST_SKIP() << name << " is not set; scripts/fetch_data.sh prints its value";
  }
  const fs::path out = fs::temp_directory_path() / ("periost-golden-" + GetParam());
  fs::remove_all(out);
  const std::string command = kProgram.string() + " run " + config.string() + " --out " + out.string() +
                              " --progress none --quiet > /dev/null 2> " + out.string() + ".log";
  const int status = std::system(command.c_str());
  std::ifstream log(out.string() + ".log");
  std::stringstream said;
  said << log.rdbuf();

  json facts = read_json(facts_file);
  ASSERT_FALSE(facts.is_null()) << facts_file << " is missing";
  EXPECT_EQ(WEXITSTATUS(status), facts.at("exit_code").get<int>()) << said.str();
  for (const auto& file : facts.at("files")) {
    EXPECT_TRUE(fs::exists(out / file.get<std::string>())) << file << " was not left by the run";
  }

  const json quality = read_json(out / "quality.json");
  const bool is_update = std::getenv("PERIOST_UPDATE_GOLDEN") != nullptr;
  for (auto& [pointer, fact] : facts.at("quality").items()) {
    const json::json_pointer path(pointer);
    ASSERT_TRUE(quality.contains(path)) << pointer << " is not in quality.json";
    const json& value = quality.at(path);
    if (is_update) {
      if (value != fact.at("value"))
        std::cout << GetParam() << pointer << ": " << fact.at("value") << " -> " << value << "\n";
      fact["value"] = value;
    } else if (value.is_number()) {
      const double expected = fact.at("value").get<double>();
      EXPECT_LE(std::abs(value.get<double>() - expected), fact.at("tolerance").get<double>())
          << pointer << " is " << value << ", expected " << expected;
    } else {
      EXPECT_EQ(value, fact.at("value")) << pointer;
    }
  }
  if (is_update) std::ofstream(facts_file) << facts.dump(2) << "\n";
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
