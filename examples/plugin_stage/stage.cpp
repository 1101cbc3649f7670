// The stage laplacian_smoothing: what the framework needs to know of it.
#include "pipeline/stage/stage.h"

#include "laplacian_smoothing.h"

namespace smoothing_example {

using namespace periost;
using Options = LaplacianSmoothingOptions;

class LaplacianSmoothingStage final : public StageOf<Options> {
 public:
  void declare(Declaration<Options>& d) const override {
    // Points move, triangles stay: what held for the surface before holds for it after.
    d.stage("laplacian_smoothing", 1, "Smooths a surface without shrinking it.")
        .input<SurfaceMesh>("surface", "The surface to smooth.",
                            {.closed = true, .manifold = true, .oriented = true})
        .output<SurfaceMesh>("surface", "The smoothed surface.",
                             {.closed = true, .manifold = true, .oriented = true})
        .param("iterations", &Options::iterations, Quantity::kCount, Range::between(0, 1000),
               "Pairs of a smoothing and an inflating step.")
        .param("smoothing", &Options::smoothing, Quantity::kFraction, Range::fraction(),
               "Share of the way to the mean of the neighbours in a smoothing step.")
        .param("inflation", &Options::inflation, Quantity::kFraction, Range::fraction(),
               "Share of the way back in an inflating step; 0 shrinks the surface.");
  }
  void preflight(const Options& options, Preflight& preflight) const override {
    if (options.inflation > 0 && options.inflation < options.smoothing) {
      preflight.warning("laplacian_smoothing.shrinks", "inflation",
                        "an inflation below the smoothing shrinks the surface");
    }
    const Forecast surface = preflight.inputs["surface"];
    preflight.outputs["surface"] = surface;
    preflight.peak_bytes = surface.triangles * 100;
  }
  Outputs run(const Options& options, const Inputs& inputs, Context& context) const override {
    return {smooth(inputs.get<SurfaceMesh>("surface"), options, context)};
  }
};

}  // namespace smoothing_example

PERIOST_STAGE(laplacian_smoothing, smoothing_example::LaplacianSmoothingStage)
