// Declaration of `decimate` and its adapter.
#include "pipeline/stage/stage.h"
#include "stages/decimate/hints.h"

namespace periost {

static std::vector<Choice<DecimateMethod>> choices_of(DecimateMethod) {
  return {{DecimateMethod::kCertified, "certified",
           "the distance of the triangulation is proved in both directions, and its angles are gated"},
          {DecimateMethod::kPaper, "paper",
           "sections 4.2 to 4.4 of the paper to the letter: the distance of vertices and face centres only"}};
}

static std::vector<Choice<ReverseDistance>> choices_of(ReverseDistance) {
  return {{ReverseDistance::kNone, "none", "only the mesh is held near the isosurface"},
          {ReverseDistance::kOnce, "1", "the isosurface lies within `distance` of the mesh, too"},
          {ReverseDistance::kTwice, "2", "the isosurface lies within twice `distance` of the mesh"}};
}

static std::vector<Choice<SmallComponents>> choices_of(SmallComponents) {
  return {{SmallComponents::kKeep, "keep", "tiny surfaces stay as they are"},
          {SmallComponents::kDrop, "drop", "tiny surfaces are left out"}};
}

static void declare_params(ParamTable<EdgeLimit>& table) {
  table.param("point", &EdgeLimit::point, Quantity::kLength, Range::required(), "The place, in mm, LPS.")
      .param("radius", &EdgeLimit::radius, Quantity::kLength, Range::above(0).and_required(),
             "How far around it the limit holds, in mm.")
      .param("max_edge", &EdgeLimit::max_edge, Quantity::kLength, Range::above(0).and_required(),
             "Longest edge there.");
}

namespace {

class DecimateStage final : public StageOf<DecimateOptions> {
 public:
  void declare(Declaration<DecimateOptions>& d) const override {
    using O = DecimateOptions;
    d.stage("decimate", 3, "Decimates an isosurface as a deformable simplex mesh.")
        .input<Isosurface>("isosurface", "The surface to decimate, open or closed.",
                           {.manifold = true, .oriented = true})
        .optional_input<Hints>("hints",
                               "With feedback, where edges are to be shorter or the distance smaller.")
        .output<SimplexMesh>("simplex_mesh", "The decimated model, closed if the isosurface is.",
                             {.closed = true, .manifold = true, .oriented = true})
        .param("method", &O::method, Quantity::kNone, Range::any(), "The decimation scheme.")
        .param("distance", &O::distance, Quantity::kLength, Range::above(0),
               "Largest distance to the isosurface; voxels are of the largest voxel side.")
        .param("min_barycentric", &O::min_barycentric, Quantity::kNumber, Range::between(0, 0.33),
               "Geometric criterion: least barycentric coordinate of a vertex's foot among its neighbours.")
        .param("topology", &O::topology, Quantity::kCount, Range::between(2, 20),
               "Topological criterion T: greatest difference between the valences of the faces beside and "
               "across an edge.")
        .param("rigidity", &O::rigidity, Quantity::kCount, Range::between(0, 10),
               "Extent s of the neighbourhood over which the curvature is smoothed, in edges.")
        .param("stiffness", &O::stiffness, Quantity::kNumber, Range::between(0, 1),
               "Pull beta towards the isosurface, against smoothness.")
        .param("damping", &O::damping, Quantity::kNumber, Range::between(0, 1),
               "Damping gamma of the law of motion; 1 leaves no inertia.")
        .param("iterations", &O::iterations, Quantity::kCount, Range::between(0, 100),
               "Steps of the law of motion after each operator.")
        .param("min_angle", &O::min_angle, Quantity::kAngle, Range::between(0, 45),
               "Smallest angle of a triangle of the triangulation (method certified).")
        .param(
            "min_edge_angle", &O::min_edge_angle, Quantity::kAngle, Range::between(0, 60),
            "Smallest dihedral angle at an edge, within the body or outside of it, that decimation may make "
            "(method certified).")
        .param(
            "grading", &O::grading, Quantity::kNumber, Range::at_least(0),
            "Greatest ratio between the longest edges of neighbouring triangles that decimation may make; 0 "
            "sets no limit (method certified).")
        .param("max_edge", &O::max_edge, Quantity::kLength, Range::at_least(0),
               "Longest edge that decimation may make; 0 sets no limit (method certified).")
        .param(
            "edge_per_thickness", &O::edge_per_thickness, Quantity::kNumber, Range::at_least(0),
            "Longest edge in parts of the distance to the next sheet, across a thin wall or a narrow gap; 0 "
            "sets no limit (method certified).")
        .param("refine", &O::refine, Quantity::kNone, Range::any(),
               "Places around which edges are kept shorter (method certified).")
        .param("reverse", &O::reverse, Quantity::kNone, Range::any(),
               "How far the isosurface may lie from the triangulation, in distances (method certified).")
        .param("max_triangles", &O::max_triangles, Quantity::kCount, Range::at_least(0),
               "Stops when the triangulation has no more triangles than this, but for the mending of bad "
               "angles; "
               "0 goes on as long as the criteria allow (method certified).")
        .param(
            "rounds", &O::rounds, Quantity::kCount, Range::between(0, 100),
            "Most rounds of last removals, each with mending, as long as they remove anything; 0 takes two "
            "on a large surface and up to twelve on a small one (method certified).")
        .param("small_components", &O::small_components, Quantity::kNone, Range::any(),
               "What happens to closed surfaces of fewer than small_triangles triangles.")
        .param("small_triangles", &O::small_triangles, Quantity::kCount, Range::between(0, 1e6),
               "Below this many triangles a component is not decimated.")
        .param(
            "pieces", &O::pieces, Quantity::kCount, Range::between(0, 10000),
            "Parts that the isosurface is cut into along planes of the image, decimated apart and sewn; 0 "
            "leaves it whole, or, with method certified and a memory budget, takes as many as keep to that.")
        .param("seed", &O::seed, Quantity::kCount, Range::at_least(0),
               "Seed of the random order of edges; 0 takes the run's.");
  }

  void preflight(const DecimateOptions& options, Preflight& preflight) const override {
    const Forecast& in = preflight.inputs["isosurface"];
    Forecast& out = preflight.outputs["simplex_mesh"];
    out.triangles = in.triangles;
    out.voxel_mm = in.voxel_mm;
    // With a budget `certified` takes as many pieces as it needs.
    preflight.peak_bytes =
        in.triangles *
        (options.method == DecimateMethod::kCertified ? kLeastBytesPerTriangle : kBytesPerTriangle);
  }

  Outputs run(const DecimateOptions& options, const Inputs& inputs, Context& context) const override {
    const auto hints = inputs.find<Hints>("hints");
    return {decimate(inputs.get<Isosurface>("isosurface"), with_hints(options, hints.get()), context)};
  }

 private:
  static constexpr std::uint64_t kBytesPerTriangle = 300, kLeastBytesPerTriangle = 60;
};

}  // namespace
}  // namespace periost

PERIOST_STAGE(decimate, periost::DecimateStage)
