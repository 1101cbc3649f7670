#pragma once
// Where a voxel grid lies in the patient: the map from voxel indices (i, j, k) to LPS millimetres.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "pipeline/data/vec.h"

namespace periost {

// Voxel centre (i, j, k) lies at origin + direction * (spacing o (i, j, k)). `direction` is orthonormal; its
// determinant may be negative (left-handed grids keep their memory order). i varies fastest in memory.
struct GridFrame {
  std::array<std::int32_t, 3> dims{0, 0, 0};
  Vec3 spacing{1, 1, 1};
  Vec3 origin;
  Mat3 direction;

  std::size_t voxel_count() const {
    return static_cast<std::size_t>(dims[0]) * static_cast<std::size_t>(dims[1]) *
           static_cast<std::size_t>(dims[2]);
  }
  std::size_t offset(std::int32_t i, std::int32_t j, std::int32_t k) const {
    return static_cast<std::size_t>(i) +
           static_cast<std::size_t>(dims[0]) *
               (static_cast<std::size_t>(j) +
                static_cast<std::size_t>(dims[1]) * static_cast<std::size_t>(k));
  }
  bool contains(std::int32_t i, std::int32_t j, std::int32_t k) const {
    return i >= 0 && j >= 0 && k >= 0 && i < dims[0] && j < dims[1] && k < dims[2];
  }
  Vec3 to_lps(Vec3 index) const {
    return origin + direction * Vec3{index.x * spacing.x, index.y * spacing.y, index.z * spacing.z};
  }
  Vec3 to_index(Vec3 lps) const {
    const Vec3 local = direction.transposed_times(lps - origin);
    return {local.x / spacing.x, local.y / spacing.y, local.z / spacing.z};
  }
  // The largest voxel side, the unit of `0.3 voxel`.
  double largest_spacing() const { return std::max({spacing.x, spacing.y, spacing.z}); }
  bool is_left_handed() const { return direction.determinant() < 0; }
  friend bool operator==(const GridFrame&, const GridFrame&) = default;
};

// True when two grids have the same size and each corner voxel of one lies within `tolerance` voxels of the
// other's.
bool same_grid(const GridFrame& a, const GridFrame& b, double tolerance = 1e-3);

}  // namespace periost
