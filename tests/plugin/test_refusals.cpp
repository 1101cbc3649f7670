// Every way in which a plugin can fail to fit: one sentence, exit code 2, and nothing of it stays registered.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include "pipeline/base/error.h"
#include "pipeline/stage/plugin_loader.h"

namespace periost {
namespace {

struct NoOptions {};
class TakenStage final : public StageOf<NoOptions> {
 public:
  void declare(Declaration<NoOptions>& d) const override { d.stage("taken", 1, "Does nothing."); }
  Outputs run(const NoOptions&, const Inputs&, Context&) const override { return {}; }
};

const std::filesystem::path kFolder = std::filesystem::path(PERIOST_BUILD_DIR) / "tests/bad_plugins";

struct Case {
  const char* file;
  const char* code;
  const char* words;
};

class Refusal : public testing::TestWithParam<Case> {};

TEST_P(Refusal, IsOneSentenceAndLeavesNothing) {
  Registry registry;
  register_stage(registry, std::make_unique<TakenStage>());
  try {
    load_plugin(kFolder / (std::string(GetParam().file) + ".so"), registry);
    FAIL() << "it was loaded";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kUsage);
    EXPECT_EQ(error.code(), GetParam().code);
    EXPECT_THAT(error.what(), testing::HasSubstr(GetParam().words));
    EXPECT_THAT(error.what(), testing::Not(testing::HasSubstr("\n")));
  }
  EXPECT_THAT(registry.names(), testing::ElementsAre("taken"));
}

INSTANTIATE_TEST_SUITE_P(
    All, Refusal,
    testing::Values(Case{"magic", "plugin.wrong_magic", "not one of Periost's"},
                    Case{"null", "plugin.wrong_magic", "not one of Periost's"},
                    Case{"size", "plugin.wrong_size", "has 8 bytes"},
                    Case{"epoch", "plugin.wrong_epoch", "interface 3"},
                    Case{"fingerprint", "plugin.wrong_toolchain", "built with 'gcc 4.9'"},
                    Case{"no_fingerprint", "plugin.wrong_toolchain", "built with ''"},
                    Case{"sizes", "plugin.wrong_toolchain", "other sizes"},
                    Case{"no_entry", "plugin.no_entry", "no function 'periost_plugin'"},
                    Case{"unresolved", "plugin.unreadable", "periost_nobody_defines_this"},
                    Case{"throws", "plugin.register_failed", "out of luck"},
                    Case{"throws_anything", "plugin.register_failed", "failed while registering"},
                    Case{"duplicate", "plugin.duplicate_stage", "'taken' is registered twice"},
                    Case{"twice", "plugin.duplicate_stage", "'first_of_twice' is registered twice"},
                    Case{"bad_name", "plugin.bad_declaration", "not snake_case"},
                    Case{"empty", "plugin.no_stage", "registers no stage"},
                    Case{"there_is_none", "plugin.unreadable", "no such file"}),
    [](const auto& test) { return std::string(test.param.file); });

TEST(Plugin, AFileThatIsNoLibraryIsRefused) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "text.so";
  std::ofstream(file) << "not a library";
  Registry registry;
  try {
    load_plugin(file, registry);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), "plugin.unreadable");
  }
}

TEST(Plugin, AGoodOneIsLoadedOnceAndTheOthersAreReported) {
  Registry registry;
  Diagnostics diagnostics;
  const std::string path = (kFolder / "none.so").string();
  const auto loaded = load_plugins({path, kFolder / "magic.so"}, path + ":" + (kFolder / "epoch.so").string(),
                                   registry, diagnostics);
  ASSERT_EQ(loaded.size(), 1u);
  EXPECT_EQ(loaded[0].licence, "BSD-3-Clause");
  EXPECT_THAT(registry.names(), testing::ElementsAre("first_of_none"));
  EXPECT_EQ(registry.find("first_of_none")->origin, path);
  ASSERT_EQ(diagnostics.size(), 2u);
  EXPECT_EQ(diagnostics[0].code, "plugin.wrong_magic");
  EXPECT_EQ(diagnostics[1].code, "plugin.wrong_epoch");
}

TEST(Plugin, AFolderIsSearched) {
  Registry registry;
  Diagnostics diagnostics;
  load_plugins({}, kFolder.string(), registry, diagnostics);
  EXPECT_NE(registry.find("first_of_none"), nullptr);
  EXPECT_GE(diagnostics.size(), 10u);
}

}  // namespace
}  // namespace periost
