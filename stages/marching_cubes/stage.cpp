#include "pipeline/stage/stage.h"
#include "stages/marching_cubes/marching_cubes.h"

namespace periost {
namespace {

class MarchingCubesStage final : public StageOf<MarchingCubesOptions> {
 public:
  void declare(Declaration<MarchingCubesOptions>& d) const override {
    d.stage("marching_cubes", 1,
            "Extracts the isosurface of a mask, subvoxel where a grey image is behind it.")
        .input<Mask>("mask", "What is inside, and the threshold that decided it.")
        .optional_input<Image>("image",
                               "The grey image behind the mask; it places the surface within voxels.")
        .output<Isosurface>(
            "isosurface",
            "The surface, with the voxels that it runs through. With `open: true` it may be open, "
            "and a stage that needs a closed one refuses it when it runs.",
            {.closed = true, .manifold = true, .oriented = true})
        .param(
            "open", &MarchingCubesOptions::open, Quantity::kNone, Range::any(),
            "Leave the surface open where the object touches the image border, instead of closing it there.")
        .param("keep", &MarchingCubesOptions::keep, Quantity::kCount, Range::any(),
               "Connected surfaces that stay, those with the most triangles first. Voxels that touch at a "
               "corner are "
               "one component of a mask and yet two bodies of a mesh; a dropped cavity is filled.");
  }

  void preflight(const MarchingCubesOptions& /*options*/, Preflight& preflight) const override {
    const Forecast& mask = preflight.inputs["mask"];
    Forecast& out = preflight.outputs["isosurface"];
    out = mask;
    const auto side = [&](std::size_t a) { return static_cast<std::uint64_t>(mask.dims[a]); };
    // A skull CT at a bone threshold, fragments and all, has 6 triangles for each voxel on half of the
    // image's border, as counted here; its largest component 4.
    out.triangles = 6 * (side(0) * side(1) + side(1) * side(2) + side(2) * side(0));
    preflight.peak_bytes = 60 * out.triangles;
  }

  Outputs run(const MarchingCubesOptions& options, const Inputs& inputs, Context& context) const override {
    return {marching_cubes(inputs.find<Image>("image").get(), inputs.get<Mask>("mask"), options, context)};
  }
};

}  // namespace
}  // namespace periost

PERIOST_STAGE(marching_cubes, periost::MarchingCubesStage)
