#pragma once
// Cutting and merging isosurfaces along the planes of their image (paper, sections 3.3 and 4.5). A cut splits
// the voxels, never a triangle: plane c of an axis runs through the voxel centres with index c, between the
// cells c - 1 and c, and meets the surface in edges of its triangles. Those edges form the isocontours.
#include <array>
#include <cstdint>
#include <vector>

#include "pipeline/data/isosurface.h"

namespace periost {

// Parallel planes, ascending; they cut a surface into at.size() + 1 parts. Every c is in 1 .. dims - 2, so
// that no cut runs where an open surface ends.
struct CutPlanes {
  int axis = 2;  // 0, 1, 2: across i, j, k
  std::vector<std::int32_t> at;
  friend bool operator==(const CutPlanes&, const CutPlanes&) = default;
};

// What one plane cuts through.
struct CutCost {
  std::uint32_t contours = 0;  // isocontours: connected curves, closed or ending at the image border
  double length_mm = 0;        // of all of them
  friend bool operator==(const CutCost&, const CutCost&) = default;
};

// The cost of plane c of axis a at [a][c], c from 0 to dims - 1, for all three axes at once. O(triangles).
std::array<std::vector<CutCost>, 3> cut_costs(const Isosurface& isosurface);

// Planes for `pieces` parts of equal numbers of triangles within a tenth: of the planes that keep to that,
// those with the fewest isocontours, then the shortest; of the three directions the one with the fewest in
// all, then the shortest, then the first. Fewer planes where the image has too few. Precondition: pieces > 0.
// A function of the surface alone. O(triangles).
CutPlanes choose_cut(const Isosurface& isosurface, std::uint32_t pieces);

// Part `part` of at.size() + 1, counted from low indices: the triangles of its cells in their order, with a
// vertex table of their own, points bit by bit those of the whole. It is open along the cuts; a part may be
// empty. Fields are left out. O(points + triangles of the whole).
Isosurface cut_part(const Isosurface& isosurface, const CutPlanes& planes, std::size_t part);

// Joins isosurfaces of one grid that share no cell by their common vertices: border points with the same
// bits. Triangles come out sorted by block and cell, so all parts of a cut, in any order, give the triangles
// of the whole, corner by corner the same points in the same order; only the numbers of the points may
// differ. `is_open` tells whether an edge is left with one triangle. Precondition: not empty, equal frames.
// O(n log n) in border points.
Isosurface merge_isosurfaces(const std::vector<Isosurface>& parts);

}  // namespace periost
