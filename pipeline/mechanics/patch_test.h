#pragma once
// The patch test: displacements that are linear in the coordinates are prescribed on the boundary, and the
// nodes inside must find the same field, since its stress is uniform and in equilibrium by itself. Elements
// that fail it do not converge to the truth however fine the mesh (Irons and Razzaque 1972). What it finds in
// a mesh: mid-side nodes in a wrong order or not shared, neighbours that do not fit, coordinates too poor for
// the shape of the elements.
#include "pipeline/base/context.h"
#include "pipeline/data/tet_mesh.h"
#include "pipeline/mechanics/stiffness.h"

namespace periost {

struct PatchTest {
  double error = 0;  // largest distance from the field at a node, to the field's largest displacement
  std::size_t free_nodes = 0;  // nodes inside; 0: there was nothing to find
};

// Solved iteratively to a residual of 1e-13. The field has stretches, shears and a rotation, about the middle
// of the bounding box. Precondition: `stiffness` is that of `mesh`.
PatchTest patch_test(const TetMesh& mesh, const Stiffness& stiffness, const Context& context);

// Whether each point is on the boundary: used by a face of one tetrahedron only, mid-side nodes included.
std::vector<bool> boundary_nodes(const TetMesh& mesh);

}  // namespace periost
