#include "pipeline/stage/stage.h"
#include "stages/phantom/phantom.h"

namespace periost {

static std::vector<Choice<PhantomShape>> choices_of(PhantomShape /*unused*/) {
  return {
      {PhantomShape::kSphere, "sphere", "A ball; grey, threshold 500."},
      {PhantomShape::kTorus, "torus", "A ring; grey, threshold 500."},
      {PhantomShape::kCube, "cube", "A rotated cube, all stairs; binary, threshold 0.5."},
      {PhantomShape::kVentricle, "ventricle", "Brain ventricles, strongly curved; binary, threshold 0.5."},
      {PhantomShape::kVessel, "vessel", "A branching tree of vessels; HU, threshold 190."},
      {PhantomShape::kFemur, "femur",
       "A thigh bone with cortex, trabecular bone and marrow; HU, threshold 226."},
      {PhantomShape::kNoise, "noise", "White noise of whole numbers 0 to 7; threshold 4."},
      {PhantomShape::kSheets, "sheets", "Thin plates close to each other; grey, threshold 500."}};
}

namespace {

class PhantomStage final : public StageOf<PhantomOptions> {
 public:
  void declare(Declaration<PhantomOptions>& d) const override {
    d.stage("phantom", 1, "Makes a synthetic image, for examples, tests and benchmarks.")
        .output<Image>("image", "The image.")
        .param("shape", &PhantomOptions::shape, Quantity::kNone, Range::any(), "What the image shows.")
        .param("size", &PhantomOptions::size, Quantity::kCount, Range::at_least(1),
               "Voxels along i, j and k; each shape has a size of its own.")
        .param("spacing", &PhantomOptions::spacing, Quantity::kLength, Range::above(0),
               "Voxel sides along i, j and k; each shape has a spacing of its own.")
        .param("origin", &PhantomOptions::origin, Quantity::kLength, Range::any(),
               "Centre of the first voxel in LPS.")
        .param("direction", &PhantomOptions::direction, Quantity::kNumber, Range::between(-1, 1),
               "Unit vectors of the axes i, j and k in LPS, one after the other.")
        .param("radius", &PhantomOptions::radius, Quantity::kLength, Range::above(0),
               "Radius of sphere or ring, half the side of the cube; left out, the shape fits the image.")
        .param("noise", &PhantomOptions::noise, Quantity::kNumber, Range::at_least(0),
               "Standard deviation of the grey values; for a binary shape, how many voxels its surface is "
               "roughened.")
        .param("seed", &PhantomOptions::seed, Quantity::kCount, Range::any(),
               "Chooses the noise, the branches and the texture.");
  }

  void preflight(const PhantomOptions& options, Preflight& preflight) const override {
    Forecast& image = preflight.outputs["image"];
    if (options.size) image.dims = *options.size;
    if (options.spacing)
      image.voxel_mm = std::max({options.spacing->x, options.spacing->y, options.spacing->z});
    preflight.peak_bytes = sizeof(float);
    for (const std::int32_t side : image.dims) preflight.peak_bytes *= static_cast<std::uint64_t>(side);
  }

  Outputs run(const PhantomOptions& options, const Inputs& /*inputs*/, Context& context) const override {
    return {make_phantom(options, context)};
  }
};

}  // namespace
}  // namespace periost

PERIOST_STAGE(phantom, periost::PhantomStage)
