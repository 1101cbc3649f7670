#pragma once
// A surface without an image behind it, say one that was read, in the place of an isosurface.
#include "pipeline/data/isosurface.h"

namespace periost {

// An isosurface with these triangles, in their order, and without voxels: has_voxels() is false and
// surface.voxel_mm 0, so lengths in voxels have no meaning. Its frame, parallel to the axes, has cells as
// wide as the mean edge and begins at the least corner; no border plane of an image holds its contours.
// Fields are left out. Preconditions: indices valid, points finite. O(n log n).
Isosurface isosurface_of_surface(const SurfaceMesh& surface);

}  // namespace periost
