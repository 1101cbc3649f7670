#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/process.h"

namespace periost::test {
namespace {

using testing::HasSubstr;

TEST(CommandLine, VersionNamesTheProgramAndItsLibraries) {
  const ProcessResult result = run_process({periost_program(), "--version"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.out, testing::StartsWith("periost "));
  EXPECT_THAT(result.out, HasSubstr("VTK 9."));
  EXPECT_EQ(result.err, "");
}

TEST(CommandLine, WithoutACommandItSaysWhatIsMissing) {
  const ProcessResult result = run_process({periost_program()});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("command is missing"));
  EXPECT_EQ(result.out, "");
}

TEST(CommandLine, UnknownOptionIsUsage) {
  const ProcessResult result = run_process({periost_program(), "--versoin"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("unknown option '--versoin'; did you mean '--version'?"));
}

}  // namespace
}  // namespace periost::test
