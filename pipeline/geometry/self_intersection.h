#pragma once
// Where a surface meets itself: pairs of triangles that have a point in common beyond the corners and edges
// they share. What a mesher of volumes refuses, and what no stage may produce.
#include <cstddef>
#include <utility>
#include <vector>

#include "pipeline/base/context.h"
#include "pipeline/data/surface_mesh.h"

namespace periost {

inline constexpr std::size_t kAllIntersections = static_cast<std::size_t>(-1);

// The intersecting pairs (i, j) of triangles, i < j, in ascending order; at most the `limit` smallest. Exact:
// touching at a point counts, and so do overlaps in one plane and points that coincide without being the same
// point (see triangles_intersect). Triangles that repeat a corner are left out: topology reports those.
//
// Preconditions: indices valid, coordinates finite. About n log n for n triangles of similar size, 0.2 kB a
// triangle; the same result for any number of threads. Throws Error{kInterrupted}.
std::vector<std::pair<Index, Index>> self_intersections(const SurfaceMesh& surface, const Context& context,
                                                        std::size_t limit = kAllIntersections);

}  // namespace periost
