#pragma once
// Cuts the polygon of one cell loop into triangles.
#include <array>
#include <cstdint>

#include "pipeline/data/vec.h"
#include "stages/marching_cubes/case_table.h"

namespace periost {

// Triangles by positions on the loop, oriented as the loop. `count` is 0 when no triangulation keeps to the
// allowed chords; the caller then joins the loop to its centroid.
struct LoopTriangles {
  int count = 0;
  std::array<std::array<std::uint8_t, 3>, kCellEdges - 2> triangles{};
};

// The triangulation of the loop with the largest minimum angle among those that use allowed chords only, by
// dynamic programming over the spans of the loop; of equal ones, the first found. points[n] is the vertex on
// loop.edges[n]. O(size^3), size <= 12.
LoopTriangles triangulate_loop(const CellLoop& loop, const std::array<Vec3, kCellEdges>& points);

// Grows with the smallest angle of the triangle: minus the squared cosine of it. -1 for a degenerate one.
double smallest_angle_measure(Vec3 a, Vec3 b, Vec3 c);

}  // namespace periost
