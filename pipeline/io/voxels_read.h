#pragma once
// The voxels of an image whose header was read.
#include <vector>

#include "pipeline/base/context.h"
#include "pipeline/io/image_layout.h"

namespace periost {

// Reads frame.voxel_count() voxels in blocks, scaled to the image's unit. The claim of the header is compared
// with the size of the file first; after the last voxel the checksum of compressed bytes is verified. Throws
// Error{kInput}: "image.truncated", "image.corrupt", "image.not_finite".
std::vector<float> read_voxels(const ImageLayout& layout, bool replace_non_finite, const Context& context);

}  // namespace periost
