#include <gmock/gmock.h>

#include "pipeline/base/error.h"
#include "pipeline/stage/registry.h"

namespace periost {
namespace {

struct CopyOptions {
  double factor = 1;
};

class CopyStage final : public StageOf<CopyOptions> {
 public:
  explicit CopyStage(std::string name, Range range = Range::above(0))
      : name_(std::move(name)), range_(range) {}
  void declare(Declaration<CopyOptions>& d) const override {
    d.stage(name_, 1, "Scales an image.")
        .input<Image>("image", "What to scale.")
        .output<Image>("image", "The scaled image.")
        .param("factor", &CopyOptions::factor, Quantity::kNumber, range_, "Multiplies every value.");
  }
  Outputs run(const CopyOptions& options, const Inputs& inputs, Context&) const override {
    Image image = inputs.get<Image>("image");
    for (float& value : image.values) value *= static_cast<float>(options.factor);
    return {std::move(image)};
  }

 private:
  std::string name_;
  Range range_;
};

TEST(Registry, FindsAndSuggests) {
  Registry registry;
  register_stage(registry, std::make_unique<CopyStage>("smooth"));
  register_stage(registry, std::make_unique<CopyStage>("crop"));
  EXPECT_THAT(registry.names(), testing::ElementsAre("crop", "smooth"));
  ASSERT_NE(registry.find("crop"), nullptr);
  EXPECT_EQ(registry.find("crop")->declaration.inputs.at(0).kind, ArtefactKind::kImage);
  EXPECT_EQ(registry.find("corp"), nullptr);
  EXPECT_EQ(registry.nearest("corp"), "crop");
}

TEST(Registry, RefusesADuplicateName) {
  Registry registry;
  register_stage(registry, std::make_unique<CopyStage>("crop"));
  try {
    register_stage(registry, std::make_unique<CopyStage>("crop"));
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), "plugin.duplicate_stage");
    EXPECT_EQ(error.kind(), ErrorKind::kUsage);
  }
}

TEST(Registry, RefusesADefaultOutOfRangeAndABadName) {
  Registry registry;
  EXPECT_THROW(register_stage(registry, std::make_unique<CopyStage>("crop", Range::above(1))), Error);
  EXPECT_THROW(register_stage(registry, std::make_unique<CopyStage>("Crop")), Error);
  EXPECT_TRUE(registry.names().empty());
}

TEST(Stage, RunsThroughTheErasedInterface) {
  const CopyStage stage("crop");
  Diagnostics diagnostics;
  Value::Entry entry{"factor", {}, Value::scalar("3")};
  const std::any options = stage.declaration().params->decode(Value::map({entry}), diagnostics);
  Inputs inputs;
  auto image = std::make_shared<Image>();
  image->values = {2};
  inputs.set("image", std::shared_ptr<const Image>(image));
  Context context;
  const Outputs outputs = stage.run_any(options, inputs, context);
  EXPECT_EQ(std::get<std::shared_ptr<const Image>>(outputs.artefacts().at(0))->values.at(0), 6);
}

}  // namespace
}  // namespace periost
