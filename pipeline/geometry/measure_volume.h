#pragma once
// The volume half of measure_quality.h.
#include "pipeline/geometry/measure_quality.h"

namespace periost {

// Fills the metrics of a tetrahedral mesh and their worst elements. `size_ratio` has one value per face
// between two tetrahedra; its worst elements are the faces' first tetrahedra. A tetrahedron counts as
// inverted when its volume, or at second order the mapping's determinant at a corner, is not positive. Worst
// tetrahedra name in `origin` how many of their corners lie on the boundary.
VolumeQuality measure_volume(const TetMesh& mesh, const Context& context, WorstElements& worst);

// The boundary of a mesh as a surface over the mesh's own points: `mesh.boundary`, or the faces used once
// where that is empty.
SurfaceMesh boundary_surface(const TetMesh& mesh);

}  // namespace periost
