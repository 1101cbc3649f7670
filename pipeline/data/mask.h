#pragma once
// Which voxels belong to the object, and the threshold that chose them if one did.
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "pipeline/data/grid_frame.h"

namespace periost {

// Grey values in [lower, upper] are inside, bounds included.
struct ThresholdRange {
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  friend bool operator==(const ThresholdRange&, const ThresholdRange&) = default;
};

// `inside` has frame.voxel_count() entries of 0 or 1. With `range`, marching cubes places the surface at the
// exact grey value wherever the mask agrees with the threshold; without it, midway between voxels.
struct Mask {
  GridFrame frame;
  std::vector<std::uint8_t> inside;
  std::optional<ThresholdRange> range;
};

}  // namespace periost
