#include "pipeline/stage/stage.h"
#include "pipeline/base/error.h"
#include "pipeline/geometry/curve_boundary.h"
#include "pipeline/io/image_read.h"
#include "stages/tetgen/hints.h"

namespace periost {

static std::vector<Choice<SizeFrame>> choices_of(SizeFrame) {
  return {{SizeFrame::kLps, "lps", "x to the left, y to posterior, z to superior, as in every file of ours."},
          {SizeFrame::kRas, "ras", "x to the right, y to anterior, z to superior, as in NIfTI."}};
}

static std::vector<Choice<Cavities>> choices_of(Cavities) {
  return {{Cavities::kEmpty, "empty", "Cavities stay holes."},
          {Cavities::kFilled, "filled", "Cavities are meshed, too, each as a region of its own."}};
}

static void declare_params(ParamTable<SizeBall>& table) {
  table.param("at", &SizeBall::at, Quantity::kLength, Range::required(), "Centre of the ball.")
      .param("radius", &SizeBall::radius, Quantity::kLength, Range::at_least(0),
             "Its radius; 0 for the centre alone.")
      .param("size", &SizeBall::size, Quantity::kLength, Range::above(0).and_required(),
             "Largest edge inside it.")
      .param("frame", &SizeBall::frame, Quantity::kNone, Range::any(),
             "Which way x and y of the centre run.");
}

static void declare_params(ParamTable<SizeOptions>& table) {
  table
      .param("inside", &SizeOptions::inside, Quantity::kLength, Range::at_least(0),
             "Largest edge far from the surface; 0 sets no limit.")
      .param("near_surface", &SizeOptions::near_surface, Quantity::kLength, Range::at_least(0),
             "Largest edge at the surface; 0 takes 1.4 times the edges that the surface has there.")
      .param("gradation", &SizeOptions::gradation, Quantity::kNumber, Range::between(0.01, 10),
             "By how many mm the largest edge may grow on a way of 1 mm.")
      .param("around", &SizeOptions::around, Quantity::kNone, Range::any(),
             "Balls in which the mesh is to be finer.")
      .param("field", &SizeOptions::field, Quantity::kInputPath, Range::any(),
             "An image whose values are largest edges in mm; 0 asks for nothing.");
}

namespace {

class TetgenStage final : public StageOf<TetgenOptions> {
 public:
  void declare(Declaration<TetgenOptions>& d) const override {
    d.stage("tetgen", 2, "Fills a closed surface with tetrahedra by TetGen, in a process of its own.")
        .input<SurfaceMesh>("surface", "The surface to fill.",
                            {.closed = true, .manifold = true, .oriented = true})
        .optional_input<Isosurface>("isosurface", "What mid-side nodes are placed on with curved: true.")
        .optional_input<Hints>("hints", "With feedback, where tetrahedra are to be smaller.")
        .output<TetMesh>("tet_mesh", "Tetrahedra with the number of their body and the boundary.")
        .param(
            "max_radius_edge", &TetgenOptions::max_radius_edge, Quantity::kNumber, Range::at_least(1),
            "Largest ratio of circumradius to shortest edge of a tetrahedron; below 1.2 TetGen may not end.")
        .param("min_dihedral", &TetgenOptions::min_dihedral, Quantity::kAngle, Range::between(0, 30),
               "Smallest dihedral angle that refinement aims at; above 15 deg TetGen may not end.")
        .param("max_volume", &TetgenOptions::max_volume, Quantity::kVolume, Range::at_least(0),
               "Largest volume of a tetrahedron, which optimisation may exceed by a fifth or so; 0 sets no "
               "limit.")
        .param("sizes", &TetgenOptions::sizes, Quantity::kNone, Range::any(),
               "Largest edges by place: far from the surface, at it, around points, by an image.")
        .param("cavities", &TetgenOptions::cavities, Quantity::kNone, Range::any(),
               "What becomes of closed surfaces inside a body.")
        .param("preserve_surface", &TetgenOptions::preserve_surface, Quantity::kNone, Range::any(),
               "Keep every triangle of the surface; otherwise TetGen may add points on it.")
        .param("order", &TetgenOptions::order, Quantity::kCount, Range::between(1, 2),
               "1 for linear tetrahedra, 2 for quadratic ones with mid-side nodes.")
        .param("curved", &TetgenOptions::curved, Quantity::kNone, Range::any(),
               "With order 2: place the mid-side nodes of the boundary on the isosurface.")
        .param("min_jacobian", &TetgenOptions::min_jacobian, Quantity::kNumber, Range::between(0, 1),
               "With curved: smallest over largest Jacobian that an element may have; else its nodes stay "
               "straight.")
        .param("optimise", &TetgenOptions::optimise, Quantity::kAngle, Range::between(0, 180),
               "TetGen works at the end on dihedral angles above this; 0 switches that off.")
        .param("time_limit", &TetgenOptions::time_limit, Quantity::kSeconds, Range::above(0),
               "Seconds after which TetGen is stopped.")
        .param("memory_limit", &TetgenOptions::memory_limit, Quantity::kBytes, Range::any(),
               "Memory of TetGen's process; 0 leaves it to --memory.");
  }

  void preflight(const TetgenOptions& options, Preflight& preflight) const override {
    const Forecast& surface = preflight.inputs["surface"];
    Forecast& out = preflight.outputs["tet_mesh"];
    out.voxel_mm = surface.voxel_mm;
    // Kept surfaces of bones give two to four tetrahedra a triangle; without a kept surface four times that.
    out.tets = surface.triangles * (options.preserve_surface ? 4 : 16);
    preflight.peak_bytes = 250 * out.tets;
    if (options.curved && (options.order != 2 || !preflight.inputs.contains("isosurface"))) {
      preflight.error("tetgen.curved", "curved",
                      options.order != 2 ? "elements of first order have no mid-side nodes"
                                         : "there is no isosurface before this stage",
                      options.order != 2 ? "set order: 2" : "start the chain from an image");
    }
    if (!options.sizes.field.empty()) check_field(options, preflight);
    if (options.max_radius_edge < 1.2 || options.min_dihedral.degrees > 15) {
      preflight.warning("tetgen.may_not_end",
                        options.max_radius_edge < 1.2 ? "max_radius_edge" : "min_dihedral",
                        "TetGen often does not end with a quality this high",
                        "leave it at the default and let `improve` raise the quality");
    }
  }

  static void check_field(const TetgenOptions& options, Preflight& preflight) {
    try {
      preflight.reads = read_image_header(options.sizes.field).files;
    } catch (const Error& error) {
      preflight.error(error.code(), "sizes", error.what(), error.hint());
    }
  }

  Outputs run(const TetgenOptions& options, const Inputs& inputs, Context& context) const override {
    const auto hints = inputs.find<Hints>("hints");
    TetMesh mesh =
        tetrahedralize(inputs.get<SurfaceMesh>("surface"), with_hints(options, hints.get()), context);
    if (options.curved) {
      curve_boundary_and_log(mesh, inputs.get<Isosurface>("isosurface"), {options.min_jacobian},
                             "tetgen.curved", context);
    }
    return {std::move(mesh)};
  }
};

}  // namespace
}  // namespace periost

PERIOST_STAGE(tetgen, periost::TetgenStage)
