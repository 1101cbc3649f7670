#include "pipeline/stage/stage.h"
#include "stages/tetgen/tetgen.h"

namespace periost {
namespace {

class TetgenStage final : public StageOf<TetgenOptions> {
 public:
  void declare(Declaration<TetgenOptions>& d) const override {
    d.stage("tetgen", 1, "Fills a closed surface with tetrahedra by TetGen, in a process of its own.")
        .input<SurfaceMesh>("surface", "The surface to fill.",
                            {.closed = true, .manifold = true, .oriented = true})
        .output<TetMesh>("tet_mesh", "Tetrahedra with the number of their body and the boundary.")
        .param(
            "max_radius_edge", &TetgenOptions::max_radius_edge, Quantity::kNumber, Range::at_least(1),
            "Largest ratio of circumradius to shortest edge of a tetrahedron; below 1.2 TetGen may not end.")
        .param("min_dihedral", &TetgenOptions::min_dihedral, Quantity::kAngle, Range::between(0, 30),
               "Smallest dihedral angle that refinement aims at; above 15 deg TetGen may not end.")
        .param("max_volume", &TetgenOptions::max_volume, Quantity::kVolume, Range::at_least(0),
               "Largest volume of a tetrahedron, which optimisation may exceed by a fifth or so; 0 sets no "
               "limit.")
        .param("preserve_surface", &TetgenOptions::preserve_surface, Quantity::kNone, Range::any(),
               "Keep every triangle of the surface; otherwise TetGen may add points on it.")
        .param("order", &TetgenOptions::order, Quantity::kCount, Range::between(1, 2),
               "1 for linear tetrahedra, 2 for quadratic ones with mid-side nodes.")
        .param("optimise", &TetgenOptions::optimise, Quantity::kAngle, Range::between(0, 180),
               "TetGen works at the end on dihedral angles above this; 0 switches that off.")
        .param("time_limit", &TetgenOptions::time_limit, Quantity::kSeconds, Range::above(0),
               "Seconds after which TetGen is stopped.");
  }

  void preflight(const TetgenOptions& options, Preflight& preflight) const override {
    const Forecast& surface = preflight.inputs["surface"];
    Forecast& out = preflight.outputs["tet_mesh"];
    out.voxel_mm = surface.voxel_mm;
    // Kept surfaces of bones give two to four tetrahedra a triangle; without a kept surface four times that.
    out.tets = surface.triangles * (options.preserve_surface ? 4 : 16);
    preflight.peak_bytes = 250 * out.tets;
    if (options.max_radius_edge < 1.2 || options.min_dihedral.degrees > 15) {
      preflight.warning("tetgen.may_not_end",
                        options.max_radius_edge < 1.2 ? "max_radius_edge" : "min_dihedral",
                        "TetGen often does not end with a quality this high",
                        "leave it at the default and let `improve` raise the quality");
    }
  }

  Outputs run(const TetgenOptions& options, const Inputs& inputs, Context& context) const override {
    return {tetrahedralize(inputs.get<SurfaceMesh>("surface"), options, context)};
  }
};

}  // namespace
}  // namespace periost

PERIOST_STAGE(tetgen, periost::TetgenStage)
