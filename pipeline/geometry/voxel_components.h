#pragma once
// Connected components of the voxels of a binary grid, by runs along i and union-find.
#include <array>
#include <cstdint>
#include <vector>

#include "pipeline/base/context.h"
#include "pipeline/data/surface_mesh.h"

namespace periost {

enum class Connectivity {
  kFaces,    // 6 neighbours
  kCorners,  // 26 neighbours
};

// Voxels begin .. end - 1 of one row.
struct VoxelRun {
  std::int32_t begin = 0;
  std::int32_t end = 0;
  Index component = kNoIndex;
};

struct VoxelComponent {
  std::uint64_t voxels = 0;
  bool touches_border = false;  // holds a voxel on the outermost layer of the grid
};

// Runs of row (j, k) are those from row_first[j + dims[1] * k] to row_first of the next row. Components are
// numbered in the order of their first voxels, i fastest.
struct VoxelComponents {
  std::array<std::int32_t, 3> dims{};
  std::vector<std::size_t> row_first;
  std::vector<VoxelRun> runs;
  std::vector<VoxelComponent> components;
};

// Labels the voxels whose byte is zero (`of_zeros`) or is not. `bytes` has dims[0] * dims[1] * dims[2]
// entries, i fastest. The same for any number of threads. Linear in voxels, all but linear in runs. Throws
// Error{kLimit, "components.too_many"} past 2^32 - 1 runs.
VoxelComponents label_components(const std::array<std::int32_t, 3>& dims,
                                 const std::vector<std::uint8_t>& bytes, bool of_zeros,
                                 Connectivity connectivity, const Context& context);

// Numbers of the components from the largest to the smallest; of equal ones the first in the grid comes
// first.
std::vector<Index> components_by_size(const VoxelComponents& labels);

// Sets the bytes of all voxels of the components with selected[component] != 0 to `value`.
void set_components(const VoxelComponents& labels, const std::vector<std::uint8_t>& selected,
                    std::uint8_t value, std::vector<std::uint8_t>& bytes, const Context& context);

}  // namespace periost
