#pragma once
// What a user asks of the mesh's size, gathered on one grid that TetGen's worker looks it up on.
#include "pipeline/base/context.h"
#include "pipeline/data/image.h"
#include "pipeline/data/surface_mesh.h"
#include "stages/tetgen/tetgen.h"
#include "workers/tetgen/size_grid.h"

namespace periost {

// The largest edge wanted at every place in the box of the surface, whose points are the patient's less
// `centre`. The smallest of: `inside`; at the surface `near_surface`, or 1.4 times the longest edge
// of its triangle; in the ball around each point its size; the value of `field` (null: none). From every
// place it grows by `gradation` at most. Where the surface is kept, a size below the edges that it has cannot
// be reached: there the surface's longest edge counts, and it counts less by 1 mm for every mm away from it.
//
// The grid's step is half the smallest size asked for, or more, so that there are at most two million nodes;
// sizes are never too large at a node, but a ball smaller than the step becomes as large as that. Linear in
// nodes and in the volume of the triangles' boxes. Independent of threads.
// Throws Error{kInput, "tetgen.size_field"} when a value of the field is below 0 or none is above.
periost_tetgen::SizeGrid make_size_grid(const SurfaceMesh& surface, Vec3 centre, const TetgenOptions& options,
                                        const Image* field, const Context& context);

}  // namespace periost
