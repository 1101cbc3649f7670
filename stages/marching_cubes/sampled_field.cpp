#include <algorithm>
#include <cmath>
#include <cstring>

#include "stages/marching_cubes/slab.h"

namespace periost {
namespace {

// Bounds |g|, so that products of two values and the edge parameter stay finite.
constexpr double kLargest = 1e30;
constexpr float kSmallest = 1e-30f;

// Gathers eight bytes of 0 or 1 into eight bits, the first byte lowest.
std::uint64_t gather_bits(const std::uint8_t* bytes) {
  std::uint64_t word = 0;
  std::memcpy(&word, bytes, sizeof word);
  return word * 0x0102040810204080u >> 56;
}

}  // namespace

SampledField::SampledField(const Image* image, const Mask& mask, bool open)
    : frame_(&mask.frame), inside_(mask.inside.data()), first_(open ? 1 : 0) {
  if (image == nullptr || !mask.range) return;
  grey_ = image->values.data();
  range_ = *mask.range;
  const double scale = std::isfinite(range_.lower) ? range_.lower : range_.upper;
  just_ = static_cast<float>(1e-6 * std::clamp(std::abs(scale), 1.0, kLargest));
}

float SampledField::voxel_value(std::int32_t i, std::int32_t j, std::int32_t k) const {
  const std::size_t voxel = frame_->offset(i, j, k);
  const bool is_inside = inside_[voxel] != 0;
  if (grey_ == nullptr) return is_inside ? 1.0f : -1.0f;
  const double grey = static_cast<double>(grey_[voxel]);
  const double g = std::min(grey - range_.lower, range_.upper - grey);
  // Also where grey is not a number.
  if (!(is_inside ? g >= 0 : g < 0)) return is_inside ? just_ : -just_;
  return static_cast<float>(std::clamp(g, -kLargest, kLargest));
}

float SampledField::value(std::int32_t x, std::int32_t y, std::int32_t z) const {
  const auto& dims = frame_->dims;
  const std::int32_t i = std::clamp(x - 1, 0, dims[0] - 1);
  const std::int32_t j = std::clamp(y - 1, 0, dims[1] - 1);
  const std::int32_t k = std::clamp(z - 1, 0, dims[2] - 1);
  const float g = voxel_value(i, j, k);
  const bool is_voxel = i == x - 1 && j == y - 1 && k == z - 1;
  return is_voxel ? g : -std::max(std::abs(g), kSmallest);
}

void SampledField::add_inside_bits(std::int32_t y, std::int32_t z, std::uint64_t* bits) const {
  if (y < 1 || z < 1 || y > frame_->dims[1] || z > frame_->dims[2]) return;
  const std::uint8_t* row = inside_ + frame_->offset(0, y - 1, z - 1);
  const std::int32_t count = frame_->dims[0];
  const auto put = [&](std::int32_t i, std::uint64_t value) {
    const auto bit = static_cast<std::uint32_t>(i) + 1;  // sample of voxel i
    bits[bit / 64] |= value << bit % 64;
    if (bit % 64 > 56) bits[bit / 64 + 1] |= value >> (64 - bit % 64);
  };
  std::int32_t i = 0;
  for (; i + 8 <= count; i += 8) put(i, gather_bits(row + i));
  for (; i < count; ++i) put(i, row[i]);
}

}  // namespace periost
