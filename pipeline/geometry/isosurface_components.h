#pragma once
// The connected surfaces of an isosurface, by size.
#include <cstdint>

#include "pipeline/data/isosurface.h"

namespace periost {

// Keeps the `count` connected surfaces with the most triangles (of equal ones those that come first) and
// drops the others with the vertices that only they used; returns how many were dropped. Order of triangles,
// points and blocks stays; blocks left empty stay in the table with no triangles. A cavity is a surface of
// its own: dropping it fills it. Precondition: count > 0; marching_cubes' guarantees. Linear in triangles and
// points.
std::uint32_t keep_largest_surfaces(Isosurface& isosurface, std::uint32_t count);

// Likewise drops the surfaces of fewer than `least` triangles. Works without voxels, too.
void drop_small_surfaces(Isosurface& isosurface, std::size_t least);

}  // namespace periost
