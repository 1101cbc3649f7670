// Definition of sample_stages.h; included by one source of each test program that uses it.
#include "tests/support/sample_stages.h"

namespace periost::sample {

struct ReadOptions {
  std::filesystem::path path;
};

class ReadStage final : public StageOf<ReadOptions> {
 public:
  void declare(Declaration<ReadOptions>& d) const override {
    d.stage("read", 1, "Reads an image.")
        .output<Image>("image", "The image.")
        .param("path", &ReadOptions::path, Quantity::kNone, Range::required(), "The file to read.");
  }
  void preflight(const ReadOptions& options, Preflight& preflight) const override {
    if (options.path.filename() == "missing.nii") {
      preflight.error("image.missing", "path", "there is no file 'missing.nii'");
    }
    preflight.reads.push_back(options.path);
    preflight.outputs["image"].dims = {100, 100, 100};
    preflight.peak_bytes = 1000;
  }
  Outputs run(const ReadOptions&, const Inputs&, Context&) const override { return {Image{}}; }
};

struct Keep {
  std::uint32_t count = 0;
  static std::optional<Keep> parse(std::string_view text) {
    if (text == "all") return Keep{0};
    const auto number = parse_number(text);
    if (!number || *number < 1) return std::nullopt;
    return Keep{static_cast<std::uint32_t>(*number)};
  }
  std::string text() const { return count == 0 ? "all" : std::to_string(count); }
  static std::string form() { return "all | N"; }
};

struct Gate {
  std::optional<double> limit;
  std::optional<double> warn;
};
inline void declare_params(ParamTable<Gate>& params) {
  params.param("limit", &Gate::limit, Quantity::kNumber, Range::any(), "Fails beyond it.")
      .param("warn", &Gate::warn, Quantity::kNumber, Range::any(), "Warns beyond it.");
}

struct MeshOptions {
  Length distance = Length::voxel(0.3);
  int iterations = 10;
  bool pad = true;
  Keep keep;
  std::vector<std::string> format{"stl"};
  std::map<std::string, Gate> gates;
};

class MeshStage final : public StageOf<MeshOptions> {
 public:
  void declare(Declaration<MeshOptions>& d) const override {
    d.stage("mesh", 1, "Makes a closed surface.")
        .input<Image>("image", "The image.")
        .optional_input<Mask>("mask", "Where to look.")
        .output<SurfaceMesh>("surface", "The surface.", {.closed = true, .manifold = true, .oriented = true})
        .param("distance", &MeshOptions::distance, Quantity::kLength, Range::above(0), "Largest distance.")
        .param("iterations", &MeshOptions::iterations, Quantity::kCount, Range::between(0, 100), "How often.")
        .param("pad", &MeshOptions::pad, Quantity::kNone, Range::any(), "Pads the image.")
        .param("keep", &MeshOptions::keep, Quantity::kNone, Range::any(), "Components that stay.")
        .param("format", &MeshOptions::format, Quantity::kNone, Range::any(), "Formats.")
        .param("gates", &MeshOptions::gates, Quantity::kNone, Range::any(), "Gates by metric.");
  }
  void preflight(const MeshOptions&, Preflight& preflight) const override {
    preflight.outputs["surface"].triangles =
        static_cast<std::uint64_t>(preflight.inputs.at("image").dims[0]) * 10;
    preflight.peak_bytes = 500;
  }
  Outputs run(const MeshOptions&, const Inputs&, Context&) const override { return {SurfaceMesh{}}; }
};

struct NoOptions {};

class OpenMeshStage final : public StageOf<NoOptions> {
 public:
  void declare(Declaration<NoOptions>& d) const override {
    d.stage("open_mesh", 1, "Makes a surface.")
        .input<Image>("image", "The image.")
        .output<SurfaceMesh>("surface", "The surface.");
  }
  Outputs run(const NoOptions&, const Inputs&, Context&) const override { return {SurfaceMesh{}}; }
};

class TetsStage final : public StageOf<NoOptions> {
 public:
  void declare(Declaration<NoOptions>& d) const override {
    d.stage("tets", 1, "Fills a surface.")
        .input<SurfaceMesh>("surface", "The surface.", {.closed = true})
        .output<TetMesh>("tet_mesh", "The mesh.");
  }
  Outputs run(const NoOptions&, const Inputs&, Context&) const override { return {TetMesh{}}; }
};

class CompareStage final : public StageOf<NoOptions> {
 public:
  void declare(Declaration<NoOptions>& d) const override {
    d.stage("compare", 1, "Compares two surfaces.")
        .input<SurfaceMesh>("surface", "The surface.")
        .input<SurfaceMesh>("reference", "What it should be.")
        .output<QualityReport>("quality", "How they differ.");
  }
  Outputs run(const NoOptions&, const Inputs&, Context&) const override { return {QualityReport{}}; }
};

class TwinsStage final : public StageOf<NoOptions> {
 public:
  void declare(Declaration<NoOptions>& d) const override {
    d.stage("twins", 1, "Makes two surfaces.")
        .input<Image>("image", "The image.")
        .output<SurfaceMesh>("left", "One.", {.closed = true})
        .output<SurfaceMesh>("right", "The other.", {.closed = true});
  }
  Outputs run(const NoOptions&, const Inputs&, Context&) const override {
    return {SurfaceMesh{}, SurfaceMesh{}};
  }
};

void register_stages(Registry& registry) {
  register_stage(registry, std::make_unique<ReadStage>());
  register_stage(registry, std::make_unique<MeshStage>());
  register_stage(registry, std::make_unique<OpenMeshStage>());
  register_stage(registry, std::make_unique<TetsStage>());
  register_stage(registry, std::make_unique<CompareStage>());
  register_stage(registry, std::make_unique<TwinsStage>());
}

}  // namespace periost::sample
