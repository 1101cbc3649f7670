#include "stages/threshold/threshold.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "pipeline/base/error.h"
#include "pipeline/base/parallel.h"
#include "pipeline/base/quantity.h"
#include "pipeline/geometry/voxel_components.h"

namespace periost {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kBlock = 1 << 18;  // voxels in one piece of work

// What one pass over the values finds.
struct Tally {
  std::size_t inside = 0;
  float smallest = std::numeric_limits<float>::infinity();
  float largest = -std::numeric_limits<float>::infinity();
};

Tally mark(const Image& image, const ThresholdRange& range, std::vector<std::uint8_t>& inside,
           const Context& context) {
  const std::size_t count = image.values.size();
  std::vector<Tally> tallies((count + kBlock - 1) / kBlock);
  parallel_blocks(context, count, kBlock, [&](std::size_t begin, std::size_t end) {
    Tally tally;
    for (std::size_t v = begin; v < end; ++v) {
      const float value = image.values[v];
      const auto grey = static_cast<double>(value);
      const bool is_inside = grey >= range.lower && grey <= range.upper;
      inside[v] = is_inside ? 1 : 0;
      tally.inside += inside[v];
      tally.smallest = value < tally.smallest ? value : tally.smallest;
      tally.largest = value > tally.largest ? value : tally.largest;
    }
    tallies[begin / kBlock] = tally;
  });
  Tally total;
  for (const Tally& tally : tallies) {
    total.inside += tally.inside;
    total.smallest = std::min(total.smallest, tally.smallest);
    total.largest = std::max(total.largest, tally.largest);
  }
  return total;
}

std::string describe(const ThresholdRange& range) {
  if (range.upper == kInfinity) return fmt::format("at least {}", range.lower);
  if (range.lower == -kInfinity) return fmt::format("at most {}", range.upper);
  return fmt::format("from {} to {}", range.lower, range.upper);
}

void check_tally(const Tally& tally, const ThresholdRange& range, std::size_t voxels,
                 const Context& context) {
  if (tally.inside == 0) {
    throw Error(ErrorKind::kInput, "threshold.nothing_inside",
                fmt::format("no voxel has a value {}: the image holds values from {} to {}", describe(range),
                            tally.smallest, tally.largest),
                "choose a threshold within the image's values; `periost inspect` lists some worth trying");
  }
  if (tally.inside == voxels) {
    context.warn("threshold.everything_inside",
                 fmt::format("every voxel has a value {}: the image holds values from {} to {}",
                             describe(range), tally.smallest, tally.largest));
  }
}

double voxel_volume(const GridFrame& frame) {
  return frame.spacing.x * frame.spacing.y * frame.spacing.z;
}

void keep_components(Mask& mask, const ThresholdOptions& options, const Context& context) {
  const VoxelComponents labels =
      label_components(mask.frame.dims, mask.inside, false, Connectivity::kCorners, context);
  const std::vector<Index> order = components_by_size(labels);
  const std::size_t count =
      options.keep.count == 0 ? order.size() : std::min<std::size_t>(options.keep.count, order.size());
  const double voxel = voxel_volume(mask.frame);
  std::vector<std::uint8_t> removed(order.size(), 1);
  std::size_t kept = 0;
  for (; kept < count; ++kept) {
    const double volume = static_cast<double>(labels.components[order[kept]].voxels) * voxel;
    if (volume < options.min_volume) break;
    removed[order[kept]] = 0;
  }
  if (kept == 0) {
    const double largest = static_cast<double>(labels.components[order[0]].voxels) * voxel;
    throw Error(ErrorKind::kInput, "threshold.all_too_small",
                fmt::format("the largest component has {:.6g} mm3, less than min_volume, {:.6g} mm3", largest,
                            options.min_volume),
                "lower min_volume or choose another threshold");
  }
  set_components(labels, removed, 0, mask.inside, context);
  context.info("threshold.components", fmt::format("kept {} of {} components", kept, order.size()));
}

void fill_cavities(Mask& mask, double up_to_mm3, const Context& context) {
  const VoxelComponents labels =
      label_components(mask.frame.dims, mask.inside, true, Connectivity::kFaces, context);
  const double voxel = voxel_volume(mask.frame);
  std::vector<std::uint8_t> filled(labels.components.size(), 0);
  std::size_t count = 0;
  std::uint64_t voxels = 0;
  for (std::size_t c = 0; c < filled.size(); ++c) {
    const VoxelComponent& component = labels.components[c];
    if (component.touches_border || static_cast<double>(component.voxels) * voxel > up_to_mm3) continue;
    filled[c] = 1;
    ++count;
    voxels += component.voxels;
  }
  if (count == 0) return;
  set_components(labels, filled, 1, mask.inside, context);
  context.info("threshold.cavities", fmt::format("filled {} cavities of {:.6g} mm3 in all", count,
                                                 static_cast<double>(voxels) * voxel));
}

}  // namespace

std::optional<FillHoles> FillHoles::parse(std::string_view text) {
  if (text == "auto") return FillHoles{};
  if (text == "none") return FillHoles{0.0};
  if (text == "all") return FillHoles{kInfinity};
  if (text.ends_with("mm3")) text.remove_suffix(3);
  if (text.ends_with(" ")) text.remove_suffix(1);
  const std::optional<double> volume = parse_number(text);
  if (!volume || *volume < 0) return std::nullopt;
  return FillHoles{*volume};
}

std::string FillHoles::text() const {
  if (!up_to_mm3) return "auto";
  if (*up_to_mm3 == 0) return "none";
  return *up_to_mm3 == kInfinity ? "all" : to_text(*up_to_mm3) + " mm3";
}

Mask threshold(const Image& image, const ThresholdOptions& options, const Context& context) {
  const ThresholdRange range{options.lower.value_or(-kInfinity), options.upper.value_or(kInfinity)};
  Mask mask{image.frame, std::vector<std::uint8_t>(image.values.size()), range};
  const Tally tally = mark(image, range, mask.inside, context);
  check_tally(tally, range, image.values.size(), context);
  if (options.keep.count > 0 || options.min_volume > 0) keep_components(mask, options, context);
  const double fill = options.fill_holes.up_to_mm3.value_or(options.keep.count == 1 ? kInfinity : 0.0);
  if (fill > 0) fill_cavities(mask, fill, context);
  return mask;
}

}  // namespace periost
