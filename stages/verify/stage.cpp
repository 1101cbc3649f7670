#include "pipeline/stage/stage.h"
#include "stages/verify/hints.h"
#include "stages/verify/verify.h"

namespace periost {

std::vector<Choice<Preset>> choices_of(Preset) {
  return {{Preset::kNone, "none", "Measures without gates, but for those under `gates`."},
          {Preset::kLenient, "lenient", "What a solver survives."},
          {Preset::kFeStandard, "fe-standard", "What finite elements need for usable results."},
          {Preset::kFeStrict, "fe-strict", "What careful stress analysis needs."}};
}

std::vector<Choice<MechanicsCheck>> choices_of(MechanicsCheck) {
  return {
      {MechanicsCheck::kByPreset, "by_preset", "`basic` with `fe-standard` and `fe-strict`, else `none`."},
      {MechanicsCheck::kNone, "none", "Not measured."},
      {MechanicsCheck::kBasic, "basic", "Patch test, motions without energy, conditioning."},
      {MechanicsCheck::kReference, "reference",
       "These, and stiffness, energy and stress under a load compared with the mesh `reference`; at "
       "first order and without a gate where second order does not fit."}};
}

static void declare_params(ParamTable<GateLimits>& table) {
  table
      .param("limit", &GateLimits::limit, Quantity::kNumber, Range::any(),
             "The gate fails when the metric does not meet it.")
      .param("warn", &GateLimits::warn, Quantity::kNumber, Range::any(),
             "The gate warns when the metric does not meet it.");
}

namespace {

class VerifyStage final : public StageOf<VerifyOptions> {
 public:
  void declare(Declaration<VerifyOptions>& d) const override {
    d.stage("verify", 5, "Measures surface and volume mesh and judges them by quality gates.")
        .optional_input<Isosurface>("isosurface", "What distances and volumes are compared with.")
        .optional_input<SimplexMesh>("simplex_mesh",
                                     "The decimated model, for its report and the distance asked.")
        .optional_input<SurfaceMesh>("surface", "The surface to measure.")
        .optional_input<TetMesh>("tet_mesh", "The tetrahedral mesh to measure.")
        .named_input<TetMesh>("reference", "A mesh of the undecimated isosurface, for mechanics: reference.")
        .optional_input<Hints>("hints", "With feedback, what earlier rounds asked for.")
        .output<QualityReport>("quality", "The metrics, the gates and the verdict.")
        .output<Hints>("hints", "What the failed gates ask of the next round.")
        .param("preset", &VerifyOptions::preset, Quantity::kNone, Range::any(),
               "The table of gates to apply.")
        .param("gates", &VerifyOptions::gates, Quantity::kNone, Range::any(),
               "Gates by metric path, such as `volume.min_dihedral_deg.min: {limit: 8, warn: 12}`; each "
               "replaces the "
               "preset's row, and `warn` alone makes it a warning.")
        .param("mechanics", &VerifyOptions::mechanics, Quantity::kNone, Range::any(),
               "Looks at the tetrahedral mesh as a solver would, with linear-elastic elements.")
        .param("distance_spacing", &VerifyOptions::distance_spacing, Quantity::kLength, Range::above(0),
               "Side of the pieces on which the mean distance to the isosurface is sampled; the largest "
               "distance is "
               "bounded, whatever the spacing.");
  }

  void preflight(const VerifyOptions& options, Preflight& preflight) const override {
    for (const auto& entry : options.gates) {
      if (find_metric(entry.first) != nullptr) continue;
      const std::string nearest = nearest_metric(entry.first);
      preflight.error(
          "verify.unknown_metric", "gates." + entry.first, "unknown metric '" + entry.first + "'",
          nearest.empty() ? "docs/quality.md lists the metrics" : "did you mean '" + nearest + "'?");
    }
    if (options.mechanics == MechanicsCheck::kReference && !preflight.inputs.contains("reference")) {
      preflight.error("verify.no_reference", "mechanics", "there is no mesh of the undecimated surface",
                      "write from: {reference: ID}, with the id of a tetgen stage that has "
                      "from: {surface: marching_cubes}");
    }
    const Forecast& isosurface = preflight.inputs["isosurface"];
    const Forecast& tets = preflight.inputs["tet_mesh"];
    // Searches over both surfaces with their samples, and the faces of the tetrahedra or, at first order, the
    // stiffness matrix. A matrix that outgrows the budget is left out.
    preflight.peak_bytes =
        400 * isosurface.triangles + (mechanics_of(options) == MechanicsCheck::kNone ? 160 : 500) * tets.tets;
  }

  Outputs run(const VerifyOptions& options, const Inputs& inputs, Context& context) const override {
    const auto isosurface = inputs.find<Isosurface>("isosurface");
    const auto simplex_mesh = inputs.find<SimplexMesh>("simplex_mesh");
    const auto surface = inputs.find<SurfaceMesh>("surface");
    const auto tet_mesh = inputs.find<TetMesh>("tet_mesh");
    const auto reference = inputs.find<TetMesh>("reference");
    const auto hints = inputs.find<Hints>("hints");
    const VerifyInputs verified{isosurface.get(), simplex_mesh.get(), surface.get(),
                                tet_mesh.get(),   reference.get(),    hints.get()};
    QualityReport report = verify(verified, options, context);
    Hints asked = make_hints(report, verified);
    report.rounds = asked.rounds;
    return {std::move(report), std::move(asked)};
  }
};

}  // namespace
}  // namespace periost

PERIOST_STAGE(verify, periost::VerifyStage)
