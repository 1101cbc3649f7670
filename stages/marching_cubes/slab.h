#pragma once
// The part of an isosurface in one layer of cell blocks: the unit of work of marching cubes.
//
// Inside this folder a grid is seen through its *samples*: voxel (i, j, k) is sample (i + 1, j + 1, k + 1),
// and the samples around them are the layer of padding. Cell c lies between samples c and c + 1.
#include <array>
#include <cstdint>
#include <vector>

#include "pipeline/data/image.h"
#include "pipeline/data/isosurface.h"
#include "pipeline/data/mask.h"

namespace periost {

// Values g of which the surface is the zero level: g >= 0 exactly at the voxels of the mask.
class SampledField {
 public:
  // `image` may be null: then g is 1 inside and -1 outside. Both must outlive the field.
  SampledField(const Image* image, const Mask& mask, bool open);

  const GridFrame& frame() const { return *frame_; }
  // Samples in use along an axis: first() .. last() - 1. All, or only voxels when the surface may be open.
  std::int32_t first() const { return first_; }
  std::int32_t last(std::size_t axis) const { return frame_->dims[axis] + 2 - first_; }
  // g at a sample. Padding mirrors the border voxel's value to the other side of the threshold, so that the
  // surface crosses midway.
  float value(std::int32_t x, std::int32_t y, std::int32_t z) const;
  // Sets bit x of the row of samples (y, z) where the sample is inside; `bits` is zero on entry.
  void add_inside_bits(std::int32_t y, std::int32_t z, std::uint64_t* bits) const;

 private:
  float voxel_value(std::int32_t i, std::int32_t j, std::int32_t k) const;
  const GridFrame* frame_;
  const std::uint8_t* inside_;
  const float* grey_ = nullptr;
  ThresholdRange range_;
  float just_ = 1;  // the size of a value that counts as just inside or outside
  std::int32_t first_ = 0;
};

// One slab's part of the surface. Vertices are numbered: first `own` ones on edges of its samples, those in
// its lowest slice of samples first; then the ones in its uppermost slice, which the next slab owns and
// numbers first, in the same order; then inner points of cells.
struct SlabSurface {
  std::vector<Vec3> edge_points;  // LPS mm; own ones and the next slab's
  Index own = 0;                  // how many of edge_points are this slab's
  std::vector<Vec3> inner_points;
  std::vector<Triangle> triangles;           // sorted by block, then by cell
  std::vector<CellBlock> blocks;             // first_triangle counts from this slab's first
  std::vector<std::uint32_t> block_entries;  // where each block stands in Isosurface::block_table
};

// Extracts slab `number`: the cells with indices 8 * number - 1 .. 8 * number + 6 along k.
SlabSurface extract_slab(const SampledField& field, std::int32_t number);

}  // namespace periost
