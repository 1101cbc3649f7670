#pragma once
// Segmentation by grey value, with the usual cleaning: components kept by size, enclosed cavities filled.
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include "pipeline/base/context.h"
#include "pipeline/data/image.h"
#include "pipeline/data/keep_components.h"
#include "pipeline/data/mask.h"

namespace periost {

// Which enclosed cavities are filled: `none`, `all`, those up to a volume in mm^3, or `auto`.
struct FillHoles {
  // Largest volume that is filled, mm^3: 0 none, infinity all. Nothing for `auto`: all when the largest
  // component alone is kept, else none.
  std::optional<double> up_to_mm3;

  static std::optional<FillHoles> parse(std::string_view text);
  std::string text() const;
  static std::string form() { return "auto | none | all | a volume in mm3"; }
  friend bool operator==(const FillHoles&, const FillHoles&) = default;
};

struct ThresholdOptions {
  std::optional<double> lower{};  // smallest value inside, in the image's unit; none: no bound
  std::optional<double> upper{};  // largest value inside; none: no bound
  KeepComponents keep{};          // 26-connected components of voxels that stay
  double min_volume = 0;          // smallest component that stays, mm^3
  FillHoles fill_holes{};         // cavities: background, 6-connected, that does not reach the image border
};

// The voxels with lower <= value <= upper, cleaned in this order: components by `keep` (of equal ones those
// that begin first in memory), then by `min_volume`, then cavities filled. The mask keeps the range, so that
// the isosurface can stay subvoxel. Values that are not numbers are outside. Same result for any number of
// threads. Linear in voxels.
//
// Throws Error{kInput}: "threshold.nothing_inside" with the image's own range of values;
// "threshold.all_too_small". Warns through `context` when every voxel is inside.
Mask threshold(const Image& image, const ThresholdOptions& options, const Context& context);

}  // namespace periost
