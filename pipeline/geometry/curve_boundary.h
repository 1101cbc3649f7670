#pragma once
// Second-order tetrahedra that follow the isosurface: mid-side nodes of boundary edges placed on it.
#include <cstddef>

#include "pipeline/base/context.h"
#include "pipeline/data/isosurface.h"
#include "pipeline/data/tet_mesh.h"

namespace periost {

struct CurveOptions {
  // Smallest J / largest |J| over corners, mid-side nodes and Gauss points (tet_quality.h) that an element
  // may have afterwards; 1 is straight.
  double min_jacobian_ratio = 0.5;
};

struct CurveReport {
  std::size_t nodes = 0;       // mid-side nodes on the boundary
  std::size_t moved = 0;       // of these, now on the isosurface
  std::size_t unsuitable = 0;  // left straight, since an element would have fallen below the limit
  std::size_t unseen = 0;      // left straight, since no isosurface lies before the node
  double mean_before_mm = 0;   // mean distance between the moved nodes' old and new places
};

// Moves the mid-side node of each edge of `mesh.boundary` along the mean normal of the boundary there to the
// isosurface (closest_along_line: among triangles that face the same way, so not to the other side of a thin
// wall), at most half the edge's length away. A node whose move would take an element around it below the
// limit stays; nodes are taken in ascending order. So every element has the limit or better, if it had before
// (straight ones do). Corners stay, and with them `mesh.boundary`. Linear time; independent of threads.
// Precondition: mesh.order() == 2, with nodes shared between elements.
CurveReport curve_boundary(TetMesh& mesh, const Isosurface& isosurface, const CurveOptions& options,
                           const Context& context);

// The same with one line of the log, `code`: how many nodes were moved and how many were left, and why.
// Throws Error{kUsage, code} where no image is behind the isosurface.
CurveReport curve_boundary_and_log(TetMesh& mesh, const Isosurface& isosurface, const CurveOptions& options,
                                   const char* code, const Context& context);

}  // namespace periost
