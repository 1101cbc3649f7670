// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Sizes asked for, on a grid of cubes: the largest edge, in mm, that the mesh may have at a point. Periost
// fills the grid (stages/tetgen/sizes.h), the worker looks sizes up while TetGen refines.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace periost_tetgen {

struct SizeGrid {
  std::array<double, 3> origin{};        // position of node (0, 0, 0), mm
  double spacing = 1;                    // side of a cube, mm
  std::array<std::uint32_t, 3> nodes{};  // along x, y, z; 0: no sizes are asked for
  std::vector<float> values;             // one per node, x fastest, above 0

  bool is_empty() const { return values.empty(); }
  std::size_t offset(std::size_t i, std::size_t j, std::size_t k) const {
    return i + nodes[0] * (j + nodes[1] * k);
  }
};

// Trilinear between the nodes; outside the grid the value at its nearest face. Precondition: at least one
// node along every axis, and as many values as nodes.
inline double size_at(const SizeGrid& grid, const double* point) {
  std::array<std::size_t, 3> low, high;
  std::array<double, 3> part;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double last = static_cast<double>(grid.nodes[axis] - 1);
    const double at = std::clamp((point[axis] - grid.origin[axis]) / grid.spacing, 0.0, last);
    low[axis] = static_cast<std::size_t>(at);
    high[axis] = std::min<std::size_t>(low[axis] + 1, grid.nodes[axis] - 1);
    part[axis] = at - static_cast<double>(low[axis]);
  }
  double size = 0;
  for (unsigned corner = 0; corner < 8; ++corner) {
    const bool x = (corner & 1U) != 0, y = (corner & 2U) != 0, z = (corner & 4U) != 0;
    const double weight =
        (x ? part[0] : 1 - part[0]) * (y ? part[1] : 1 - part[1]) * (z ? part[2] : 1 - part[2]);
    size += weight *
            static_cast<double>(
                grid.values[grid.offset(x ? high[0] : low[0], y ? high[1] : low[1], z ? high[2] : low[2])]);
  }
  return size;
}

}  // namespace periost_tetgen
