#include "pipeline/stage/stage.h"
#include "pipeline/geometry/curve_boundary.h"
#include "stages/improve/improve.h"

namespace periost {

static std::vector<Choice<BoundaryMotion>> choices_of(BoundaryMotion) {
  return {{BoundaryMotion::kFixed, "fixed", "Points on the boundary stay, to the last bit."},
          {BoundaryMotion::kSlide, "slide",
           "Points on the boundary move where nothing else helps, within the tolerance."}};
}

namespace {

class ImproveStage final : public StageOf<ImproveOptions> {
 public:
  void declare(Declaration<ImproveOptions>& d) const override {
    d.stage("improve", 8, "Raises the dihedral angles of a tetrahedral mesh, worst first.")
        .input<TetMesh>("tet_mesh", "The mesh to improve.")
        .optional_input<Isosurface>("isosurface", "What a sliding boundary keeps its distance from.")
        .optional_input<SimplexMesh>("simplex_mesh", "The decimated model, for the distance it was asked.")
        .optional_input<SurfaceMesh>("surface", "The surface that the mesh was made from.",
                                     {.closed = true, .manifold = true, .oriented = true})
        .output<TetMesh>("tet_mesh", "The improved mesh.")
        .output<SurfaceMesh>("surface", "The surface that bounds it now.",
                             {.closed = true, .manifold = true, .oriented = true})
        .param("target", &ImproveOptions::target, Quantity::kAngle, Range::between(0, 45),
               "Dihedral angles below it, or above 180 deg less it, are worked on.")
        .param("boundary", &ImproveOptions::boundary, Quantity::kNone, Range::any(),
               "Whether points on the boundary may move.")
        .param("tolerance", &ImproveOptions::tolerance, Quantity::kLength, Range::at_least(0),
               "Largest distance, both ways, between a boundary that slid and the isosurface; 0: what the "
               "decimator was asked.")
        .param("split_thin", &ImproveOptions::split_thin, Quantity::kNone, Range::any(),
               "Put points between the two sides of thin walls where dihedral angles stay above 20 deg.")
        .param("max_growth", &ImproveOptions::max_growth, Quantity::kFraction, Range::between(0, 1),
               "Largest growth of the number of tetrahedra, as a share of it.")
        .param("curved", &ImproveOptions::curved, Quantity::kNone, Range::any(),
               "With second order: place the mid-side nodes of the boundary on the isosurface.")
        .param("min_jacobian", &ImproveOptions::min_jacobian, Quantity::kNumber, Range::between(0, 1),
               "With curved: smallest over largest Jacobian that an element may have; else its nodes stay "
               "straight.");
  }

  void preflight(const ImproveOptions& options, Preflight& preflight) const override {
    if (options.curved && !preflight.inputs.contains("isosurface")) {
      preflight.error("improve.curved", "curved", "there is no isosurface before this stage",
                      "start the chain from an image");
    }
    const Forecast& in = preflight.inputs["tet_mesh"];
    const Forecast& isosurface = preflight.inputs["isosurface"];
    preflight.outputs["tet_mesh"] = in;
    preflight.outputs["surface"] = preflight.inputs["surface"];
    preflight.peak_bytes = 250 * in.tets + 16 * isosurface.triangles;
  }

  Outputs run(const ImproveOptions& options, const Inputs& inputs, Context& context) const override {
    const auto isosurface = inputs.find<Isosurface>("isosurface");
    const auto simplex_mesh = inputs.find<SimplexMesh>("simplex_mesh");
    const auto surface = inputs.find<SurfaceMesh>("surface");
    ImproveResult result = improve(inputs.get<TetMesh>("tet_mesh"),
                                   {isosurface.get(), simplex_mesh.get(), surface.get()}, options, context);
    if (options.curved && result.mesh.order() == 2) {
      curve_boundary_and_log(result.mesh, *isosurface, {options.min_jacobian}, "improve.curved", context);
    }
    return {std::move(result.mesh), std::move(result.surface)};
  }
};

}  // namespace
}  // namespace periost

PERIOST_STAGE(improve, periost::ImproveStage)
