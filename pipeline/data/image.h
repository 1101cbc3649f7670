#pragma once
// A scalar image on a grid: grey values of a CT in Hounsfield units, or the values of a label map.
#include <string>
#include <vector>

#include "pipeline/data/grid_frame.h"

namespace periost {

// `values` has frame.voxel_count() entries, i fastest, rescaled to the image's unit. Single precision holds
// every 16-bit value exactly.
struct Image {
  GridFrame frame;
  std::vector<float> values;
};

}  // namespace periost
