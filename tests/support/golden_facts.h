#pragma once
// Facts about what a configuration leaves, in tests/golden/NAME.json: exit code, files, and values of
// quality.json with their tolerances.
#include <filesystem>
#include <string>

namespace periost::test {

// Adds a gtest failure for each fact of configuration `name` that the run in folder `out` does not keep. With
// PERIOST_UPDATE_GOLDEN set, values are rewritten and each change is printed instead.
void expect_golden_facts(const std::string& name, const std::filesystem::path& out, int exit_code);

}  // namespace periost::test
