#pragma once
// Whether a surface can be filled at all, found out before TetGen sees it.
#include "pipeline/base/context.h"
#include "pipeline/data/surface_mesh.h"

namespace periost {

// Returns if the surface is finite, closed, manifold, oriented, free of triangles without area and of
// self-intersections; throws as tetrahedralize() says otherwise.
void check_fillable(const SurfaceMesh& surface, const Context& context);

}  // namespace periost
