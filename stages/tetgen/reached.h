#pragma once
// What was asked of TetGen, against what it reached.
#include <vector>

#include "pipeline/base/context.h"
#include "stages/tetgen/tetgen.h"
#include "workers/tetgen/size_grid.h"

namespace periost {

// Edges with an end inside the body, against what was asked for at the better of their ends: length / largest
// length asked for. 1 and below is what was asked.
struct SizeReached {
  std::size_t edges = 0;
  double median = 0, p99 = 0;
};

// The first `surface_points` points are the surface's; points are in the grid's coordinates. O(n log n).
SizeReached sizes_reached(const std::vector<Vec3>& points, const std::vector<Tetrahedron>& tets,
                          std::size_t surface_points, const periost_tetgen::SizeGrid& grid);

// One line for quality ("tetgen.quality"): ratio of circumradius to shortest edge, dihedral angles, volumes,
// each asked for and reached, and how many tetrahedra fall short. One for sizes ("tetgen.sizes") if there is
// a grid.
void log_reached(const std::vector<Vec3>& points, const std::vector<Tetrahedron>& tets,
                 std::size_t surface_points, const TetgenOptions& options,
                 const periost_tetgen::SizeGrid& grid, const Context& context);

}  // namespace periost
