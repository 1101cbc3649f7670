#include "pipeline/stage/stage.h"
#include "pipeline/base/error.h"
#include "pipeline/io/surface_read.h"
#include "stages/read_surface/read_surface.h"

namespace periost {

std::vector<Choice<SurfaceUnit>> choices_of(SurfaceUnit) {
  return {{SurfaceUnit::kMicrometre, "um", "Micrometres."},
          {SurfaceUnit::kMillimetre, "mm", "Millimetres."},
          {SurfaceUnit::kCentimetre, "cm", "Centimetres."},
          {SurfaceUnit::kMetre, "m", "Metres."}};
}

std::vector<Choice<SurfaceFrame>> choices_of(SurfaceFrame) {
  return {{SurfaceFrame::kLps, "lps", "x to the left, y to posterior, z to superior, as in DICOM."},
          {SurfaceFrame::kRas, "ras", "x to the right, y to anterior, z to superior, as in NIfTI."}};
}

std::vector<Choice<SurfaceRequirement>> choices_of(SurfaceRequirement) {
  return {{SurfaceRequirement::kClosedManifold, "closed_manifold",
           "Closed, a manifold and oriented; another surface is refused with the places of its faults."},
          {SurfaceRequirement::kAny, "any", "Whatever the file holds; later stages check what they need."}};
}

namespace {

class ReadSurfaceStage final : public StageOf<ReadSurfaceOptions> {
 public:
  void declare(Declaration<ReadSurfaceOptions>& d) const override {
    d.stage("read_surface", 1, "Reads a surface made elsewhere: STL, PLY, OBJ, OFF, VTP or VTK.")
        .output<SurfaceMesh>("surface", "The surface in LPS millimetres; closed unless `require: any`.",
                             {.closed = true, .manifold = true, .oriented = true})
        .param("path", &ReadSurfaceOptions::path, Quantity::kInputPath, Range::required(),
               "The surface file.")
        .param("unit", &ReadSurfaceOptions::unit, Quantity::kNone, Range::any(),
               "What the file's coordinates are in.")
        .param("frame", &ReadSurfaceOptions::frame, Quantity::kNone, Range::any(),
               "The patient frame of the file's coordinates.")
        .param("require", &ReadSurfaceOptions::require, Quantity::kNone, Range::any(),
               "What is asked of the surface.");
  }

  void preflight(const ReadSurfaceOptions& options, Preflight& preflight) const override {
    try {
      check_surface_file(options.path);
      preflight.reads = {options.path};
      const std::uint64_t triangles = estimate_triangles(options.path);
      preflight.outputs["surface"].triangles = triangles;
      // Text, unmerged points and the sorted sides of all triangles.
      preflight.peak_bytes = 250 * triangles;
    } catch (const Error& error) {
      preflight.error(error.code(), "path", error.what(), error.hint());
    }
  }

  Outputs run(const ReadSurfaceOptions& options, const Inputs& /*inputs*/, Context& context) const override {
    return {read_surface(options, context)};
  }
};

}  // namespace
}  // namespace periost

PERIOST_STAGE(read_surface, periost::ReadSurfaceStage)
