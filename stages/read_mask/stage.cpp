#include "pipeline/stage/stage.h"
#include "pipeline/base/error.h"
#include "pipeline/io/image_read.h"
#include "stages/read_mask/read_mask.h"

namespace periost {
namespace {

class ReadMaskStage final : public StageOf<ReadMaskOptions> {
 public:
  void declare(Declaration<ReadMaskOptions>& d) const override {
    d.stage("read_mask", 1, "Reads a segmentation made elsewhere, in any image format.")
        .optional_input<Image>("image", "The image on whose grid the mask has to lie.")
        .output<Mask>("mask", "The voxels that are inside.")
        .param("path", &ReadMaskOptions::path, Quantity::kInputPath, Range::required(),
               "The file of the mask.")
        .param("labels", &ReadMaskOptions::labels, Quantity::kCount, Range::any(),
               "Values of voxels that are inside; without any, every value but 0.")
        .param("resample", &ReadMaskOptions::resample, Quantity::kNone, Range::any(),
               "Bring a mask on another grid to the image's by nearest neighbour, instead of refusing it.");
  }

  void preflight(const ReadMaskOptions& options, Preflight& preflight) const override {
    try {
      const ImageHeader header = read_image_header(options.path);
      preflight.reads = header.files;
      Forecast& mask = preflight.outputs["mask"];
      mask.dims = header.frame.dims;
      mask.voxel_mm = header.frame.largest_spacing();
      preflight.peak_bytes = header.frame.voxel_count() * (sizeof(float) + 1);
      const auto image = preflight.inputs.find("image");
      if (image == preflight.inputs.end() || image->second.dims[0] == 0) return;
      if (image->second.dims != header.frame.dims && !options.resample) {
        preflight.error("mask.frame", "path", "the mask does not have as many voxels as the image",
                        "set resample: true to bring it to the image's grid by nearest neighbour");
      }
      mask = image->second;
    } catch (const Error& error) {
      preflight.error(error.code(), "path", error.what(), error.hint());
    }
  }

  Outputs run(const ReadMaskOptions& options, const Inputs& inputs, Context& context) const override {
    const auto image = inputs.find<Image>("image");
    return {read_mask(options, image ? &image->frame : nullptr, context)};
  }
};

}  // namespace
}  // namespace periost

PERIOST_STAGE(read_mask, periost::ReadMaskStage)
