#include "stages/decimate/decimate.h"

#include "pipeline/base/error.h"
#include "pipeline/geometry/simplex_dual.h"
#include "stages/decimate/certified.h"
#include "stages/decimate/certified_pieces.h"
#include "stages/decimate/paper.h"
#include "stages/decimate/pieces.h"

namespace periost {
namespace {

// The components with fewer triangles than asked die as a whole.
void drop_small_components(SimplexMesh& mesh, int least_triangles) {
  const SimplexComponents components = components_of(mesh);
  std::vector<int> triangles(components.count, 0);
  for (const std::uint32_t component : components.of_vertex) ++triangles[component];
  for (std::size_t v = 0; v < mesh.face.size(); ++v) {
    if (triangles[components.of_vertex[v]] >= least_triangles) continue;
    for (const SimplexFace f : mesh.face[v]) mesh.valence[index_of(f)] = 0;
    mesh.face[v] = {kNoFace, kNoFace, kNoFace};
  }
  compact(mesh);
}

SimplexMesh decimate_whole(const Isosurface& isosurface, const DecimateOptions& options, double distance_mm,
                           std::uint64_t seed, Context& context) {
  ContouredMesh model{dual_simplex_mesh(isosurface.surface), {}};
  if (options.small_components == SmallComponents::kDrop)
    drop_small_components(model.mesh, options.small_triangles);
  model.contours = close_contours(model.mesh, isosurface.frame);
  decimate_paper(isosurface, options, distance_mm, seed, {}, model, context);
  open_contours(model.mesh, model.contours);
  compact(model.mesh);
  return std::move(model.mesh);
}

}  // namespace

SimplexMesh decimate(const Isosurface& isosurface, const DecimateOptions& options, Context& context) {
  const double voxel_mm = isosurface.surface.voxel_mm;
  if (options.distance.unit == Length::Unit::kVoxel && !(voxel_mm > 0)) {
    throw Error(ErrorKind::kUsage, "decimate.no_voxel",
                "the distance is in voxels, but no image is behind the surface", "give it in mm");
  }
  if (options.method == DecimateMethod::kCertified) {
    const std::uint32_t pieces =
        options.pieces > 0 ? static_cast<std::uint32_t>(options.pieces) : pieces_within(isosurface, context);
    return pieces > 1 ? decimate_certified_in_pieces(isosurface, pieces, options, context)
                      : decimate_certified(isosurface, options, context);
  }

  const double distance_mm = options.distance.in_mm(voxel_mm);
  const std::uint64_t seed = options.seed != 0 ? options.seed : context.seed;
  SimplexMesh mesh = options.pieces > 1
                         ? decimate_in_pieces(isosurface, static_cast<std::uint32_t>(options.pieces), options,
                                              distance_mm, seed, context)
                         : decimate_whole(isosurface, options, distance_mm, seed, context);
  PERIOST_ASSERT(check_simplex_mesh(mesh).empty());
  mesh.report.triangles_before = isosurface.surface.triangles.size();
  mesh.report.triangles_after = mesh.face.size();
  mesh.report.requested_distance_mm = distance_mm;
  return mesh;
}

}  // namespace periost
