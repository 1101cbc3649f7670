#include "pipeline/stage/stage.h"
#include "pipeline/base/error.h"
#include "stages/read_image/read_image.h"

namespace periost {

static std::vector<Choice<VoxelType>> choices_of(VoxelType) {
  std::vector<Choice<VoxelType>> choices;
  for (int type = 0; type <= static_cast<int>(VoxelType::kFloat64); ++type) {
    const std::string name(name_of(static_cast<VoxelType>(type)));
    choices.push_back({static_cast<VoxelType>(type), name, "Voxels stored as " + name + "."});
  }
  return choices;
}

static std::vector<Choice<ByteOrder>> choices_of(ByteOrder) {
  return {{ByteOrder::kLittle, "little", "The least significant byte first, as on PCs."},
          {ByteOrder::kBig, "big", "The most significant byte first."}};
}

static std::vector<Choice<NonFinite>> choices_of(NonFinite) {
  return {
      {NonFinite::kRefuse, "refuse", "Voxels that are NaN or infinite are an error that names the first."},
      {NonFinite::kLowest, "lowest", "They get the lowest finite value of the image, with a warning."}};
}

static void declare_params(ParamTable<RawImageOptions>& table) {
  using Raw = RawImageOptions;
  table
      .param("dims", &Raw::dims, Quantity::kCount, Range::at_least(1).and_required(),
             "Voxels along i (fastest), j and k.")
      .param("type", &Raw::type, Quantity::kNone, Range::required(), "How a voxel is stored.")
      .param("spacing", &Raw::spacing, Quantity::kLength, Range::above(0).and_required(),
             "Distance between voxel centres along i, j and k in mm.")
      .param("origin", &Raw::origin, Quantity::kLength, Range::any(), "Centre of the first voxel in mm, LPS.")
      .param("direction", &Raw::direction, Quantity::kNumber, Range::between(-1, 1),
             "Unit vectors of the axes i, j and k in LPS, one after the other.")
      .param("endian", &Raw::endian, Quantity::kNone, Range::any(), "Order of the bytes of a voxel.")
      .param("header_bytes", &Raw::header_bytes, Quantity::kCount, Range::any(),
             "Bytes at the beginning of the file to skip.");
}

namespace {

class ReadImageStage final : public StageOf<ReadImageOptions> {
 public:
  void declare(Declaration<ReadImageOptions>& d) const override {
    d.stage("read_image", 1, "Reads an image: NIfTI, MetaImage, NRRD, VTI, Inrimage, InVesalius or raw.")
        .output<Image>("image", "The image in the patient frame LPS.")
        .param("path", &ReadImageOptions::path, Quantity::kInputPath, Range::required(), "The image file.")
        .param("raw", &ReadImageOptions::raw, Quantity::kNone, Range::any(),
               "Describes a file of bare voxels, without a header of its own.")
        .param("non_finite", &ReadImageOptions::non_finite, Quantity::kNone, Range::any(),
               "What is done about voxels that are NaN or infinite.");
  }

  void preflight(const ReadImageOptions& options, Preflight& preflight) const override {
    try {
      const ImageHeader header = read_image_header(options.path, file_options(options));
      preflight.reads = header.files;
      Forecast& image = preflight.outputs["image"];
      image.dims = header.frame.dims;
      image.voxel_mm = header.frame.largest_spacing();
      preflight.peak_bytes = header.frame.voxel_count() * sizeof(float);
    } catch (const Error& error) {
      preflight.error(error.code(), "path", error.what(), error.hint());
    }
  }

  Outputs run(const ReadImageOptions& options, const Inputs& /*inputs*/, Context& context) const override {
    return {read_image(options, context)};
  }
};

}  // namespace
}  // namespace periost

PERIOST_STAGE(read_image, periost::ReadImageStage)
