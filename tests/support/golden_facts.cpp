#include "tests/support/golden_facts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>

namespace periost::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

json read_json(const fs::path& path) {
  std::ifstream file(path);
  return file ? json::parse(file) : json();
}

void expect_value(const std::string& pointer, const json& fact, const json& value) {
  const json& expected = fact.at("value");
  if (value.is_number()) {
    EXPECT_LE(std::abs(value.get<double>() - expected.get<double>()), fact.at("tolerance").get<double>())
        << pointer << " is " << value << ", expected " << expected;
  } else {
    EXPECT_EQ(value, expected) << pointer;
  }
}

}  // namespace

void expect_golden_facts(const std::string& name, const fs::path& out, int exit_code) {
  const fs::path facts_file = fs::path(PERIOST_SOURCE_DIR) / "tests/golden" / (name + ".json");
  json facts = read_json(facts_file);
  ASSERT_FALSE(facts.is_null()) << facts_file << " is missing";
  EXPECT_EQ(exit_code, facts.at("exit_code").get<int>());
  for (const auto& file : facts.at("files")) {
    EXPECT_TRUE(fs::exists(out / file.get<std::string>())) << file << " was not left by the run";
  }

  const json quality = read_json(out / "quality.json");
  const bool is_update = std::getenv("PERIOST_UPDATE_GOLDEN") != nullptr;
  for (auto& [pointer, fact] : facts.at("quality").items()) {
    const json::json_pointer path(pointer);
    ASSERT_TRUE(quality.contains(path)) << pointer << " is not in quality.json";
    const json& value = quality.at(path);
    if (!is_update) {
      expect_value(pointer, fact, value);
    } else if (value != fact.at("value")) {
      std::cout << name << pointer << ": " << fact.at("value") << " -> " << value << "\n";
      fact["value"] = value;
    }
  }
  if (is_update) std::ofstream(facts_file) << facts.dump(2) << "\n";
}

}  // namespace periost::test
