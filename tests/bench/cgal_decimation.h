#pragma once
// CGAL's ways to fewer triangles, for comparison only. What links this is under the GPL.
#include <cstddef>

#include "pipeline/data/surface_mesh.h"

namespace periost {

enum class CgalMethod { kLindstromTurk, kGarlandHeckbert, kIsotropic };

// The surface with about `triangles` triangles; `seconds` receives the time of the algorithm alone. Throws
// std::runtime_error when built without CGAL, or when CGAL does not take the surface.
SurfaceMesh cgal_decimated(const SurfaceMesh& surface, CgalMethod method, std::size_t triangles,
                           double& seconds);

}  // namespace periost
