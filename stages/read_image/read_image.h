#pragma once
// Reads a volume of grey values or labels from a file: NIfTI, MetaImage, NRRD, VTI, Inrimage, a project of
// InVesalius, or raw voxels that the options describe (docs/images.md).
#include <filesystem>
#include <optional>

#include "pipeline/base/context.h"
#include "pipeline/data/image.h"
#include "pipeline/io/image_read.h"

namespace periost {

// What to do about voxels that are NaN or infinite.
enum class NonFinite { kRefuse, kLowest };

struct ReadImageOptions {
  std::filesystem::path path;          // the file
  std::optional<RawImageOptions> raw;  // set: the file has no header that we read
  NonFinite non_finite =
      NonFinite::kRefuse;  // NaN and infinite voxels: an error, or the image's lowest value
};

ImageFileOptions file_options(const ReadImageOptions& options);

// Reads the image and logs its format, size, spacing, orientation and range of values, but nothing that could
// name a person. Errors as read_image(path).
Image read_image(const ReadImageOptions& options, const Context& context);

}  // namespace periost
