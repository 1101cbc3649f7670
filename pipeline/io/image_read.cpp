#include "pipeline/io/image_read.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pipeline/base/error.h"
#include "pipeline/io/image_layout.h"
#include "pipeline/io/text_header.h"
#include "pipeline/io/voxels_read.h"

namespace periost {
namespace {

struct FormatRow {
  std::string_view ending;
  ImageLayout (*layout)(const std::filesystem::path&);
  std::vector<float> (*voxels)(const ImageLayout&, bool, const Context&);
};
constexpr FormatRow kFormats[] = {
    {".nii", nifti_layout, read_voxels},       {".nii.gz", nifti_layout, read_voxels},
    {".hdr", nifti_layout, read_voxels},       {".hdr.gz", nifti_layout, read_voxels},
    {".mha", metaimage_layout, read_voxels},   {".mhd", metaimage_layout, read_voxels},
    {".nrrd", nrrd_layout, read_voxels},       {".nhdr", nrrd_layout, read_voxels},
    {".vti", vti_layout, read_vti_voxels},     {".inr", inrimage_layout, read_voxels},
    {".inr.gz", inrimage_layout, read_voxels}, {".inv3", inv3_layout, read_voxels},
};

[[noreturn]] void refuse_dicom(const std::filesystem::path& path) {
  refuse_file(path, "image.dicom", "would be read as DICOM, which is not supported yet",
              "convert the series to NIfTI (for example with dcm2niix) and give that file");
}

void check_path(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    throw Error(ErrorKind::kInput, "image.missing", fmt::format("there is no file '{}'", path.string()),
                "check the path; a relative one starts at the configuration's folder");
  }
  const std::string name = lower_case(path.filename().string());
  if (std::filesystem::is_directory(path) || name.ends_with(".dcm") || name == "dicomdir") {
    refuse_dicom(path);
  }
}

// DICOM files often have no ending; "DICM" stands at byte 128.
bool is_dicom(const std::filesystem::path& path) {
  ByteSource source(path, Coding::kPlain);
  std::array<char, 132> head{};
  return source.read(head.data(), head.size()) == head.size() &&
         std::string_view(head.data() + 128, 4) == "DICM";
}

const FormatRow& format_of(const std::filesystem::path& path) {
  const std::string name = lower_case(path.filename().string());
  for (const FormatRow& row : kFormats) {
    if (name.ends_with(row.ending)) return row;
  }
  if (is_dicom(path)) refuse_dicom(path);
  std::string known;
  for (const FormatRow& row : kFormats) known += fmt::format(" {}", row.ending);
  refuse_file(path, "image.format", "does not have the ending of an image format that is read",
              fmt::format("endings are{}; describe a file without a header by the key raw", known));
}

}  // namespace

Image read_image(const std::filesystem::path& path, const ImageFileOptions& options, const Context& context) {
  check_path(path);
  const FormatRow* format = options.raw ? nullptr : &format_of(path);
  const ImageLayout layout = format == nullptr ? raw_layout(path, *options.raw) : format->layout(path);
  for (const std::string& note : layout.notes) context.info("image.assumed", note);
  const auto voxels = format == nullptr ? read_voxels : format->voxels;
  return {layout.frame, voxels(layout, options.replace_non_finite, context)};
}

ImageHeader read_image_header(const std::filesystem::path& path, const ImageFileOptions& options) {
  check_path(path);
  const ImageLayout layout = options.raw ? raw_layout(path, *options.raw) : format_of(path).layout(path);
  ImageHeader header{layout.frame, layout.type, layout.format, {path}};
  if (layout.data_file != path) header.files.push_back(layout.data_file);
  return header;
}

GridFrame read_image_frame(const std::filesystem::path& path, const ImageFileOptions& options) {
  return read_image_header(path, options).frame;
}

std::string describe(const GridFrame& frame) {
  constexpr std::string_view kPositive = "LPS";
  constexpr std::string_view kNegative = "RAI";
  std::string axes;
  double least_cosine = 1;
  for (const Vec3& column : frame.direction.column) {
    std::size_t main = 0;
    for (std::size_t row = 1; row < 3; ++row) {
      if (std::abs(column[row]) > std::abs(column[main])) main = row;
    }
    axes += fmt::format(" {}", (column[main] > 0 ? kPositive : kNegative)[main]);
    least_cosine = std::min(least_cosine, std::abs(column[main]));
  }
  const double tilt = std::acos(std::min(least_cosine, 1.0)) * 57.29577951308232;
  return fmt::format(
      "{} x {} x {} voxels of {:.6g} x {:.6g} x {:.6g} mm, axes{}{}, origin ({:.6g}, {:.6g}, {:.6g})",
      frame.dims[0], frame.dims[1], frame.dims[2], frame.spacing.x, frame.spacing.y, frame.spacing.z, axes,
      tilt > 1 ? fmt::format(" tilted by {:.1f} degrees", tilt) : "", frame.origin.x, frame.origin.y,
      frame.origin.z);
}

}  // namespace periost
