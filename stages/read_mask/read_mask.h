#pragma once
// Reads a segmentation that was made elsewhere: a label map or a binary volume in any image format.
#include <cstdint>
#include <filesystem>
#include <vector>

#include "pipeline/base/context.h"
#include "pipeline/data/mask.h"

namespace periost {

struct ReadMaskOptions {
  std::filesystem::path path;        // the file
  std::vector<std::int64_t> labels;  // values that are inside; none given: every value but 0
  bool resample = false;             // bring a mask on another grid to the image's by nearest neighbour
};

// `image`, if not null, is the grid on which the mask has to lie. A mask on another grid is refused with the
// largest distance between corresponding corners, or resampled: an image voxel is inside when the mask's
// voxel nearest to its centre is; outside the mask's grid nothing is inside. Throws Error{kInput}: as the
// image reader; "mask.frame" for another grid, "mask.empty" when no voxel is inside.
Mask read_mask(const ReadMaskOptions& options, const GridFrame* image, const Context& context);

// The voxels of `image` that have one of the labels (none: any value but 0).
Mask mask_of_labels(const GridFrame& frame, const std::vector<float>& values,
                    const std::vector<std::int64_t>& labels);

// O(voxels of `grid`); in parallel by slices, the same for every number of threads.
Mask resample_nearest(const Mask& mask, const GridFrame& grid, const Context& context);

}  // namespace periost
