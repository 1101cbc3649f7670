#include "pipeline/stage/stage.h"
#include "stages/write_surface/write_surface.h"

namespace periost {

std::vector<Choice<SurfaceFormat>> choices_of(SurfaceFormat) {
  return {{SurfaceFormat::kStl, "stl", "Binary STL, single precision."},
          {SurfaceFormat::kPly, "ply", "Binary PLY, double precision, with fields."},
          {SurfaceFormat::kObj, "obj", "Wavefront OBJ."},
          {SurfaceFormat::kOff, "off", "Object File Format."},
          {SurfaceFormat::kVtp, "vtp", "VTK XML, double precision, with fields."}};
}

namespace {

class WriteSurfaceStage final : public StageOf<WriteSurfaceOptions> {
 public:
  void declare(Declaration<WriteSurfaceOptions>& d) const override {
    d.stage("write_surface", 1, "Writes the surface as files for other programs.")
        .input<SurfaceMesh>("surface", "The surface to write.")
        .output<Deck>("deck", "The names of the files.")
        .param("format", &WriteSurfaceOptions::format, Quantity::kNone, Range::any(),
               "One format or several; each makes a file.")
        .param("name", &WriteSurfaceOptions::name, Quantity::kNone, Range::any(),
               "Name of the files in the output folder, without extension.");
  }

  void preflight(const WriteSurfaceOptions& options, Preflight& preflight) const override {
    if (options.format.empty()) preflight.error("write_surface.no_format", "format", "no format is given");
    if (options.name.empty() || options.name.find('/') != std::string::npos) {
      preflight.error("write_surface.bad_name", "name", "'" + options.name + "' is not the name of a file");
    }
  }

  Outputs run(const WriteSurfaceOptions& options, const Inputs& inputs, Context& context) const override {
    return {write_surface_files(inputs.get<SurfaceMesh>("surface"), options, context)};
  }
};

}  // namespace
}  // namespace periost

PERIOST_STAGE(write_surface, periost::WriteSurfaceStage)
