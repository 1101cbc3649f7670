#include "pipeline/stage/stage.h"
#include "stages/threshold/threshold.h"

namespace periost {
namespace {

class ThresholdStage final : public StageOf<ThresholdOptions> {
 public:
  void declare(Declaration<ThresholdOptions>& d) const override {
    d.stage("threshold", 1, "Segments an image by grey value, keeps components by size and fills cavities.")
        .input<Image>("image", "The grey image.")
        .output<Mask>("mask", "The voxels inside, with the threshold, so that the isosurface stays subvoxel.")
        .param("lower", &ThresholdOptions::lower, Quantity::kIntensity, Range::any(),
               "Smallest grey value inside; one of lower and upper must be given.")
        .param("upper", &ThresholdOptions::upper, Quantity::kIntensity, Range::any(),
               "Largest grey value inside.")
        .param("keep", &ThresholdOptions::keep, Quantity::kNone, Range::any(),
               "Which 26-connected components of voxels stay: all, the largest, or the N largest.")
        .param("min_volume", &ThresholdOptions::min_volume, Quantity::kVolume, Range::at_least(0),
               "Components smaller than this are removed.")
        .param("fill_holes", &ThresholdOptions::fill_holes, Quantity::kNone, Range::any(),
               "Which enclosed cavities are filled; auto fills all with `keep: largest` and else none.");
  }

  void preflight(const ThresholdOptions& options, Preflight& preflight) const override {
    if (!options.lower && !options.upper) {
      preflight.error("config.missing_key", "lower", "needs a lower or an upper grey value",
                      "add `lower: 226` for bone in a CT");
    }
    if (options.lower && options.upper && *options.lower > *options.upper) {
      preflight.error("config.out_of_range", "upper", "upper is less than lower", "exchange the two");
    }
    const Forecast& image = preflight.inputs["image"];
    preflight.outputs["mask"] = image;
    std::uint64_t voxels = 1;
    for (const std::int32_t side : image.dims) voxels *= static_cast<std::uint64_t>(side);
    preflight.peak_bytes = 2 * voxels;
  }

  Outputs run(const ThresholdOptions& options, const Inputs& inputs, Context& context) const override {
    return {threshold(inputs.get<Image>("image"), options, context)};
  }
};

}  // namespace
}  // namespace periost

PERIOST_STAGE(threshold, periost::ThresholdStage)
