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

// The same for VTK's image data, by VTK.
std::vector<float> read_vti_voxels(const ImageLayout& layout, bool replace_non_finite,
                                   const Context& context);

// Refuses voxels that are NaN or infinite ("image.not_finite"), or gives them the lowest finite value with a
// warning.
void settle_non_finite(const ImageLayout& layout, bool replace, const Context& context,
                       std::vector<float>& values);

}  // namespace periost
