#pragma once
// The order of a mesh's tetrahedra in memory. Meshers leave neighbours far from one another, and large meshes
// then cost a wait for memory at every step from one to the next.
#include "pipeline/data/tet_mesh.h"

namespace periost {

// Points, tetrahedra and regions of the mesh, without fields, with its tetrahedra along a Morton curve by
// their centroids. Points keep their order. O(n log n).
TetMesh in_curve_order(const TetMesh& mesh);

}  // namespace periost
