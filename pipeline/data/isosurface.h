#pragma once
// An isosurface kept with the voxels it runs through (Delingette 1997, section 3.1): a vertex table,
// triangles grouped by voxel, and a hash of voxel blocks that answers line and closest-point queries
// (geometry/isosurface_query.h).
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "pipeline/data/grid_frame.h"
#include "pipeline/data/surface_mesh.h"

namespace periost {

// A cubic block of 8x8x8 cells. Cell c of the block holds the triangles first[c] .. first[c + 1] - 1.
struct CellBlock {
  static constexpr int kSide = 8;
  static constexpr int kCells = kSide * kSide * kSide;
  std::array<Index, kCells + 1> first{};
};

// The grid's cells are the cubes between eight neighbouring voxel centres; cell (i, j, k) spans voxels i..i+1
// and so on, and indices may reach -1, the layer of padding. Every triangle lies inside its cell. Guarantees
// of marching_cubes: `surface` is manifold, oriented, without degenerate triangles, closed unless `is_open`;
// triangles are sorted by block, then by cell.
struct Isosurface {
  GridFrame frame;
  SurfaceMesh surface;
  std::unordered_map<std::uint64_t, CellBlock> blocks;  // keyed by block_key()
  bool is_open = false;

  // Key of the block that holds cell (i, j, k); indices >= -8.
  static std::uint64_t block_key(std::int32_t i, std::int32_t j, std::int32_t k) {
    const auto part = [](std::int32_t index) {
      return static_cast<std::uint64_t>((index + 8) / CellBlock::kSide);
    };
    return part(i) | (part(j) << 21) | (part(k) << 42);
  }
  // Position of cell (i, j, k) inside its block.
  static int cell_in_block(std::int32_t i, std::int32_t j, std::int32_t k) {
    const auto part = [](std::int32_t index) { return (index + 8) % CellBlock::kSide; };
    return part(i) + CellBlock::kSide * (part(j) + CellBlock::kSide * part(k));
  }
};

}  // namespace periost
