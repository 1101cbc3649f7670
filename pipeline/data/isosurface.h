#pragma once
// An isosurface kept with the voxels it runs through (Delingette 1997, section 3.1): a vertex table,
// triangles grouped by voxel, and a table of voxel blocks that answers line and closest-point queries
// (geometry/isosurface_query.h).
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "pipeline/data/grid_frame.h"
#include "pipeline/data/surface_mesh.h"

namespace periost {

// A cubic block of 8x8x8 cells that holds at least one triangle. Cell c of the block holds the triangles
// first_triangle + first[c] .. first_triangle + first[c + 1] - 1. A cell has at most twelve triangles, so the
// offsets fit in 16 bits.
struct CellBlock {
  static constexpr int kSide = 8;
  static constexpr int kCells = kSide * kSide * kSide;
  std::array<std::int32_t, 3> first_cell{};  // indices (i, j, k) of its cell 0
  Index first_triangle = 0;
  std::array<std::uint16_t, kCells + 1> first{};
};

// Triangles begin .. end - 1.
struct TriangleRange {
  Index begin = 0;
  Index end = 0;
};

// The grid's cells are the cubes between eight neighbouring voxel centres; cell (i, j, k) spans voxels i..i+1
// and so on, and its indices run from -1 to dims - 1, the layer of padding included. Every triangle lies
// inside its cell. Guarantees of marching_cubes: `surface` is manifold, oriented, without degenerate
// triangles, closed unless `is_open`; triangles are sorted by block, then by cell.
//
// Blocks are found by direct index: `block_table` has an entry for every block of the grid (kNoIndex where no
// triangle lies), i fastest. At four bytes for 512 voxels it is small beside any image, and faster than a
// hash.
//
// A surface that was read stands for an isosurface without voxels (geometry/isosurface_of_surface.h).
struct Isosurface {
  GridFrame frame;
  SurfaceMesh surface;
  std::vector<Index> block_table;  // positions in `blocks`
  std::vector<CellBlock> blocks;   // ascending first_triangle
  bool is_open = false;

  // Whether an image is behind it: otherwise there are no cells, and queries by voxels find nothing.
  bool has_voxels() const { return !blocks.empty(); }

  // Number of blocks along one axis of a grid that has `dims` voxels there.
  static std::int32_t block_count(std::int32_t dims) { return (dims + CellBlock::kSide) / CellBlock::kSide; }
  bool has_cell(std::int32_t i, std::int32_t j, std::int32_t k) const {
    return i >= -1 && j >= -1 && k >= -1 && i < frame.dims[0] && j < frame.dims[1] && k < frame.dims[2];
  }
  // Position in `block_table` of the block that holds a cell. Precondition: has_cell(i, j, k).
  std::size_t block_entry(std::int32_t i, std::int32_t j, std::int32_t k) const {
    const auto part = [](std::int32_t index) {
      return static_cast<std::size_t>((index + 1) / CellBlock::kSide);
    };
    const auto nx = static_cast<std::size_t>(block_count(frame.dims[0]));
    const auto ny = static_cast<std::size_t>(block_count(frame.dims[1]));
    return part(i) + nx * (part(j) + ny * part(k));
  }
  // Position of cell (i, j, k) inside its block.
  static std::size_t cell_in_block(std::int32_t i, std::int32_t j, std::int32_t k) {
    const auto part = [](std::int32_t index) {
      return static_cast<std::size_t>((index + 1) % CellBlock::kSide);
    };
    return part(i) + CellBlock::kSide * (part(j) + CellBlock::kSide * part(k));
  }
  // The triangles of a cell; empty outside the grid. Constant time.
  TriangleRange triangles_of_cell(std::int32_t i, std::int32_t j, std::int32_t k) const {
    if (!has_cell(i, j, k)) return {};
    const Index block = block_table[block_entry(i, j, k)];
    if (block == kNoIndex) return {};
    const CellBlock& cells = blocks[block];
    const std::size_t cell = cell_in_block(i, j, k);
    return {cells.first_triangle + cells.first[cell], cells.first_triangle + cells.first[cell + 1]};
  }
};

}  // namespace periost
