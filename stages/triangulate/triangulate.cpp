#include "stages/triangulate/triangulate.h"

#include <fmt/format.h>

#include "pipeline/base/error.h"
#include "pipeline/geometry/simplex_dual.h"
#include "pipeline/geometry/simplex_walk.h"

namespace periost {

SurfaceMesh triangulate(const SimplexMesh& mesh, const TriangulateOptions& options, Context& context) {
  PERIOST_ASSERT(check_simplex_mesh(mesh).empty());
  context.check_cancelled();
  SurfaceMesh surface = dual_triangulation(mesh);
  if (surface.triangles.empty()) {
    throw Error(ErrorKind::kQuality, "triangulate.empty", "the simplex mesh has no vertices to triangulate",
                "was every component dropped? See `small_components` of decimate");
  }
  Index point = 0;
  for (std::uint32_t i = 0; i < mesh.valence.size(); ++i) {
    const SimplexFace f{i};
    if (!mesh.is_live(f)) continue;
    if (options.vertices == DualPlace::kFaceCentre && !is_border(mesh, f)) {
      surface.points[point] = face_centre(mesh, f);
    }
    if (!is_finite(surface.points[point])) {
      throw Error(ErrorKind::kQuality, "triangulate.not_finite",
                  fmt::format("point {} of the triangulation is not finite", point));
    }
    ++point;
  }
  return surface;
}

}  // namespace periost
