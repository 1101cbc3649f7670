#include "stages/read_mask/read_mask.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "pipeline/base/error.h"
#include "pipeline/base/parallel.h"
#include "pipeline/io/image_read.h"

namespace periost {
namespace {

constexpr std::size_t kLabelsShown = 12;

// The largest distance between corresponding corner voxels. Precondition: equal dims.
double corner_distance(const GridFrame& a, const GridFrame& b) {
  double largest = 0;
  for (int corner = 0; corner < 8; ++corner) {
    Vec3 index;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (((corner >> axis) & 1) != 0) index[axis] = a.dims[axis] - 1.0;
    }
    largest = std::max(largest, distance(a.to_lps(index), b.to_lps(index)));
  }
  return largest;
}

[[noreturn]] void refuse_frame(const std::filesystem::path& path, const GridFrame& mask,
                               const GridFrame& image) {
  const std::string how =
      mask.dims != image.dims
          ? fmt::format("has {} x {} x {} voxels, but the image has {} x {} x {}", mask.dims[0], mask.dims[1],
                        mask.dims[2], image.dims[0], image.dims[1], image.dims[2])
          : fmt::format("lies up to {:.4g} mm away from the image's grid", corner_distance(mask, image));
  throw Error(ErrorKind::kInput, "mask.frame", fmt::format("mask '{}' {}", path.filename().string(), how),
              "set resample: true to bring it to the image's grid by nearest neighbour");
}

[[noreturn]] void refuse_empty(const ReadMaskOptions& options, const std::vector<float>& values) {
  std::set<float> present;
  for (const float value : values) {
    if (present.size() > kLabelsShown) break;
    if (value != 0) present.insert(value);
  }
  const bool has_more = present.size() > kLabelsShown;
  if (has_more) present.erase(std::prev(present.end()));
  throw Error(ErrorKind::kInput, "mask.empty",
              fmt::format("no voxel of mask '{}' is inside", options.path.filename().string()),
              present.empty()
                  ? "all its voxels are 0"
                  : fmt::format("it holds the labels {}{}", fmt::join(present, ", "), has_more ? ", …" : ""));
}

std::size_t count_inside(const Mask& mask) {
  return static_cast<std::size_t>(std::count(mask.inside.begin(), mask.inside.end(), 1));
}

}  // namespace

Mask mask_of_labels(const GridFrame& frame, const std::vector<float>& values,
                    const std::vector<std::int64_t>& labels) {
  Mask mask{frame, std::vector<std::uint8_t>(values.size()), std::nullopt};
  const std::set<std::int64_t> wanted(labels.begin(), labels.end());
  // Neighbouring voxels mostly have the same label, so the last answer is kept.
  float last = 0;
  bool last_is_inside = wanted.contains(0);
  for (std::size_t n = 0; n < values.size(); ++n) {
    if (values[n] != last) {
      last = values[n];
      const double whole = std::floor(static_cast<double>(last));
      last_is_inside = wanted.empty() ? last != 0
                                      : static_cast<double>(last) == whole && std::abs(whole) < 9e18 &&
                                            wanted.contains(static_cast<std::int64_t>(whole));
    }
    mask.inside[n] = last_is_inside ? 1 : 0;
  }
  return mask;
}

Mask resample_nearest(const Mask& mask, const GridFrame& grid, const Context& context) {
  Mask result{grid, std::vector<std::uint8_t>(grid.voxel_count()), std::nullopt};
  parallel_for(context, static_cast<std::size_t>(grid.dims[2]), [&](std::size_t k) {
    for (std::int32_t j = 0; j < grid.dims[1]; ++j) {
      const std::size_t row = grid.offset(0, j, static_cast<std::int32_t>(k));
      for (std::int32_t i = 0; i < grid.dims[0]; ++i) {
        const Vec3 at = mask.frame.to_index(
            grid.to_lps({static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)}));
        // Compared as real numbers first: a grid far away would overflow an integer.
        bool is_within = true;
        for (std::size_t a = 0; a < 3; ++a) is_within &= at[a] >= -0.5 && at[a] < mask.frame.dims[a] - 0.5;
        if (!is_within) continue;
        const auto nearest = [](double x) { return static_cast<std::int32_t>(std::floor(x + 0.5)); };
        const std::array<std::int32_t, 3> n{nearest(at.x), nearest(at.y), nearest(at.z)};
        if (mask.frame.contains(n[0], n[1], n[2])) {
          result.inside[row + static_cast<std::size_t>(i)] = mask.inside[mask.frame.offset(n[0], n[1], n[2])];
        }
      }
    }
  });
  return result;
}

Mask read_mask(const ReadMaskOptions& options, const GridFrame* image, const Context& context) {
  const Image labels = read_image(options.path, {}, context);
  const bool fits = image == nullptr || same_grid(labels.frame, *image);
  if (!fits && !options.resample) refuse_frame(options.path, labels.frame, *image);

  Mask mask = mask_of_labels(labels.frame, labels.values, options.labels);
  if (count_inside(mask) == 0) refuse_empty(options, labels.values);
  context.info("mask.read", fmt::format("{}; {} voxels inside", describe(mask.frame), count_inside(mask)));
  if (fits) {
    // Frames that differ by rounding only are made the same, so that later stages see one grid.
    if (image != nullptr) mask.frame = *image;
    return mask;
  }
  mask = resample_nearest(mask, *image, context);
  const std::size_t inside = count_inside(mask);
  context.info("mask.resampled", fmt::format("on the image's grid {} voxels are inside", inside));
  if (inside == 0) {
    throw Error(ErrorKind::kInput, "mask.empty",
                fmt::format("mask '{}' does not meet the image: after resampling no voxel is inside",
                            options.path.filename().string()),
                "check that both files are of the same scan");
  }
  return mask;
}

}  // namespace periost
