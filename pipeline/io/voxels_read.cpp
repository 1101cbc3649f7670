#include "pipeline/io/voxels_read.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>

namespace periost {
namespace {

static_assert(std::endian::native == std::endian::little, "voxels are decoded for a little-endian host");

constexpr std::size_t kBlockVoxels = std::size_t{1} << 16;

template <std::size_t Bytes>
void swap_bytes(unsigned char* bytes, std::size_t count) {
  for (std::size_t n = 0; n < count; ++n) std::reverse(bytes + n * Bytes, bytes + (n + 1) * Bytes);
}

void swap_bytes(unsigned char* bytes, std::size_t count, std::size_t size) {
  if (size == 2) swap_bytes<2>(bytes, count);
  if (size == 4) swap_bytes<4>(bytes, count);
  if (size == 8) swap_bytes<8>(bytes, count);
}

// Converts a block; returns how many integers single precision could not hold exactly.
template <class T>
std::size_t convert(const unsigned char* from, std::size_t count, double slope, double intercept, float* to) {
  const T* stored = reinterpret_cast<const T*>(from);  // the buffer is aligned for every type
  if (slope == 1 && intercept == 0) {
    for (std::size_t n = 0; n < count; ++n) to[n] = static_cast<float>(stored[n]);
  } else {
    for (std::size_t n = 0; n < count; ++n) {
      to[n] = static_cast<float>(slope * static_cast<double>(stored[n]) + intercept);
    }
  }
  std::size_t inexact = 0;
  if constexpr (std::is_integral_v<T> && sizeof(T) >= 4) {
    for (std::size_t n = 0; n < count; ++n) {
      const double whole = static_cast<double>(stored[n]);
      inexact += static_cast<double>(static_cast<float>(stored[n])) != whole;
    }
  }
  return inexact;
}

using Convert = std::size_t (*)(const unsigned char*, std::size_t, double, double, float*);
// In the order of VoxelType.
constexpr std::array<Convert, 10> kConvert{
    convert<std::int8_t>,  convert<std::uint8_t>,  convert<std::int16_t>, convert<std::uint16_t>,
    convert<std::int32_t>, convert<std::uint32_t>, convert<std::int64_t>, convert<std::uint64_t>,
    convert<float>,        convert<double>};

bool all_finite(const float* values, std::size_t count) {
  bool is_finite = true;
  for (std::size_t n = 0; n < count; ++n)
    is_finite &= std::abs(values[n]) <= std::numeric_limits<float>::max();
  return is_finite;
}

std::string index_text(const GridFrame& frame, std::size_t voxel) {
  const std::size_t row = static_cast<std::size_t>(frame.dims[0]);
  const std::size_t slice = row * static_cast<std::size_t>(frame.dims[1]);
  return fmt::format("({}, {}, {})", voxel % row, voxel % slice / row, voxel / slice);
}

void check_claim(const ImageLayout& layout, const ByteSource& source) {
  const std::uint64_t claimed = layout.frame.voxel_count() * bytes_of(layout.type);
  if (claimed <= source.most_bytes_left()) return;
  refuse_file(
      layout.data_file, "image.truncated",
      fmt::format(
          "is too small: {} x {} x {} voxels of {} take {} bytes, but the file has {}{} after its header",
          layout.frame.dims[0], layout.frame.dims[1], layout.frame.dims[2], name_of(layout.type), claimed,
          source.is_compressed() ? "room for at most " : "only ", source.most_bytes_left()),
      "the file is cut off, or its header is wrong");
}

[[noreturn]] void refuse_cut_off(const ImageLayout& layout, std::size_t voxels) {
  const std::size_t slice =
      static_cast<std::size_t>(layout.frame.dims[0]) * static_cast<std::size_t>(layout.frame.dims[1]);
  refuse_file(layout.data_file, "image.truncated",
              fmt::format("ends in slice {} of {}: {} of {} voxels are there", voxels / slice + 1,
                          layout.frame.dims[2], voxels, layout.frame.voxel_count()),
              "copy or download the file again");
}

}  // namespace

void settle_non_finite(const ImageLayout& layout, bool replace, const Context& context,
                       std::vector<float>& values) {
  std::size_t count = 0;
  std::size_t first = 0;
  float lowest = std::numeric_limits<float>::max();
  for (std::size_t n = 0; n < values.size(); ++n) {
    if (std::isfinite(values[n])) {
      lowest = std::min(lowest, values[n]);
    } else if (count++ == 0) {
      first = n;
    }
  }
  if (count == 0) return;
  const std::string where = index_text(layout.frame, first);
  if (!replace || count == values.size()) {
    refuse_file(layout.data_file, "image.not_finite",
                fmt::format("has {} voxels that are NaN or infinite, the first at index {}", count, where),
                "set non_finite: lowest to give them the lowest value of the image");
  }
  for (float& value : values) {
    if (!std::isfinite(value)) value = lowest;
  }
  context.warn(
      "image.not_finite",
      fmt::format("{} voxels are NaN or infinite, the first at index {}; they got the lowest value, {}",
                  count, where, lowest));
}

std::vector<float> read_voxels(const ImageLayout& layout, bool replace_non_finite, const Context& context) {
  ByteSource source(layout.data_file, layout.coding, layout.file_offset);
  source.skip(layout.decoded_offset, "header");
  check_claim(layout, source);

  const std::size_t count = layout.frame.voxel_count();
  const std::size_t size = bytes_of(layout.type);
  const Convert to_float = kConvert[static_cast<std::size_t>(layout.type)];
  std::vector<float> values;
  // A plain file holds all of them; a compressed one may be lying, so memory follows what it can hold at a
  // common ratio.
  values.reserve(source.is_compressed() ? std::min(count, std::size_t{8} * source.file_bytes() / size)
                                        : count);
  std::vector<double> block(kBlockVoxels * size / sizeof(double) + 1);
  unsigned char* bytes = reinterpret_cast<unsigned char*>(block.data());

  Progress progress(context, "reading voxels", count);
  bool is_finite = true;
  std::size_t inexact = 0;
  while (values.size() < count) {
    const std::size_t begin = values.size();
    const std::size_t wanted = std::min(kBlockVoxels, count - begin);
    const std::size_t got = source.read(bytes, wanted * size) / size;
    if (got < wanted) refuse_cut_off(layout, begin + got);
    if (layout.is_big_endian) swap_bytes(bytes, wanted, size);
    if (values.capacity() < begin + wanted) values.reserve(std::min(count, 2 * (begin + wanted)));
    values.resize(begin + wanted);
    inexact += to_float(bytes, wanted, layout.slope, layout.intercept, values.data() + begin);
    is_finite &= all_finite(values.data() + begin, wanted);
    progress.step(wanted);
  }
  source.check_rest(std::max<std::uint64_t>(count * size, std::uint64_t{1} << 26));
  if (!is_finite) settle_non_finite(layout, replace_non_finite, context, values);
  if (inexact > 0) {
    context.warn("image.precision",
                 fmt::format("{} voxels of type {} are beyond 2^24 and were rounded to single precision",
                             inexact, name_of(layout.type)));
  }
  return values;
}

}  // namespace periost
