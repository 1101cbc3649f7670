// Declaration of `triangulate` and its adapter.
#include "pipeline/stage/stage.h"
#include "stages/triangulate/triangulate.h"

namespace periost {

static std::vector<Choice<DualPlace>> choices_of(DualPlace) {
  return {{DualPlace::kModel, "model", "where the decimator keeps them: the points that `certified` proves"},
          {DualPlace::kFaceCentre, "face_centre",
           "at the means of the faces' vertices, the paper's face centres"}};
}

namespace {

class TriangulateStage final : public StageOf<TriangulateOptions> {
 public:
  void declare(Declaration<TriangulateOptions>& d) const override {
    d.stage("triangulate", 1, "Makes the triangulated surface that is dual to a simplex mesh.")
        .input<SimplexMesh>("simplex_mesh", "The model to triangulate.",
                            {.closed = true, .manifold = true, .oriented = true})
        .output<SurfaceMesh>("surface", "The triangulated surface.",
                             {.closed = true, .manifold = true, .oriented = true})
        .param("vertices", &TriangulateOptions::vertices, Quantity::kNone, Range::any(),
               "Where the surface's points lie.");
  }

  void preflight(const TriangulateOptions&, Preflight& preflight) const override {
    const Forecast& in = preflight.inputs["simplex_mesh"];
    Forecast& out = preflight.outputs["surface"];
    out.triangles = in.triangles;
    out.voxel_mm = in.voxel_mm;
    preflight.peak_bytes = in.triangles * kBytesPerTriangle;
  }

  Outputs run(const TriangulateOptions& options, const Inputs& inputs, Context& context) const override {
    return {triangulate(inputs.get<SimplexMesh>("simplex_mesh"), options, context)};
  }

 private:
  static constexpr std::uint64_t kBytesPerTriangle = 32;
};

}  // namespace
}  // namespace periost

PERIOST_STAGE(triangulate, periost::TriangulateStage)
