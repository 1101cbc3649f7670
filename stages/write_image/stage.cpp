#include "pipeline/stage/stage.h"
#include "pipeline/io/image_write.h"
#include "stages/write_image/write_image.h"

namespace periost {

static std::vector<Choice<WrittenVolume>> choices_of(WrittenVolume) {
  return {{WrittenVolume::kImage, "image", "The grey values, as float32."},
          {WrittenVolume::kMask, "mask", "The mask, as uint8 of 0 and 1."}};
}

namespace {

class WriteImageStage final : public StageOf<WriteImageOptions> {
 public:
  void declare(Declaration<WriteImageOptions>& d) const override {
    d.stage("write_image", 1, "Writes the image or the mask as NIfTI, MetaImage, NRRD or VTI.")
        .optional_input<Image>("image", "The image.")
        .optional_input<Mask>("mask", "The mask.")
        .output<Deck>("deck", "The file that was written.")
        .param("path", &WriteImageOptions::path, Quantity::kOutputPath, Range::any(),
               "File in the output folder; its ending (.nii .nii.gz .mha .nrrd .vti) decides the format.")
        .param("volume", &WriteImageOptions::volume, Quantity::kNone, Range::any(),
               "Which of the two is written.");
  }

  void preflight(const WriteImageOptions& options, Preflight& preflight) const override {
    if (!is_writable_image_format(written_path(options))) {
      preflight.error("image.format", "path",
                      "the file does not have the ending of an image format that is written",
                      "endings are .nii .nii.gz .mha .nrrd .vti");
    }
    const char* port = options.volume == WrittenVolume::kMask ? "mask" : "image";
    if (!preflight.inputs.contains(port)) {
      preflight.error("config.missing_input", "volume",
                      std::string("the chain has made no ") + port + " before this stage");
    }
  }

  Outputs run(const WriteImageOptions& options, const Inputs& inputs, Context& context) const override {
    return {
        write_image(inputs.find<Image>("image").get(), inputs.find<Mask>("mask").get(), options, context)};
  }
};

}  // namespace
}  // namespace periost

PERIOST_STAGE(write_image, periost::WriteImageStage)
