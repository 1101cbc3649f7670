#pragma once
// The triangulation dual to a simplex mesh (paper, section 2.2): one point for each face, one triangle for
// each vertex.
#include "pipeline/base/context.h"
#include "pipeline/data/simplex_mesh.h"
#include "pipeline/data/surface_mesh.h"

namespace periost {

enum class DualPlace { kModel, kFaceCentre };

struct TriangulateOptions {
  DualPlace vertices = DualPlace::kModel;  // where the surface's points lie
};

// Guarantees: oriented outward, manifold, closed where the mesh has no contour; face_fields become point
// fields, voxel_mm is kept. kModel takes dual_position, where the decimator put the point: `certified` proves
// its distances for these points only; `paper` puts it at the face centre, so both choices agree for it. With
// kFaceCentre, faces cut by a contour keep dual_position, since their vertices surround no centre.
// Throws Error{kQuality, "triangulate.not_finite"} naming the point that is not finite, and {kQuality,
// "triangulate.empty"} when there is nothing to triangulate. O(n).
SurfaceMesh triangulate(const SimplexMesh& mesh, const TriangulateOptions& options, Context& context);

}  // namespace periost
