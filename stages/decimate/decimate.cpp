#include "stages/decimate/decimate.h"

#include <algorithm>

#include "pipeline/base/error.h"
#include "pipeline/geometry/isosurface_components.h"
#include "pipeline/geometry/simplex_dual.h"
#include "stages/decimate/certified.h"
#include "stages/decimate/certified_pieces.h"
#include "stages/decimate/paper.h"
#include "stages/decimate/pieces.h"

namespace periost {
namespace {

SimplexMesh decimate_whole(const Isosurface& isosurface, const DecimateOptions& options, double distance_mm,
                           std::uint64_t seed, Context& context) {
  ContouredMesh model{dual_simplex_mesh(isosurface.surface), {}};
  model.contours = close_contours(model.mesh, isosurface.frame);
  decimate_paper(isosurface, options, distance_mm, seed, {}, model, context);
  open_contours(model.mesh, model.contours);
  compact(model.mesh);
  return std::move(model.mesh);
}

// What needs an image refuses a surface that has none behind it.
void require_voxels(const Isosurface& isosurface, const DecimateOptions& options) {
  const auto refuse = [](const char* text, const char* hint) {
    throw Error(ErrorKind::kUsage, "decimate.no_voxel", text, hint);
  };
  if (isosurface.surface.triangles.empty()) return;
  if (!(isosurface.surface.voxel_mm > 0)) {
    if (options.distance.unit == Length::Unit::kVoxel)
      refuse("the distance is in voxels, but no image is behind the surface", "give it in mm");
    const auto is_in_voxels = [](const EdgeLimit& limit) {
      return limit.max_edge.unit == Length::Unit::kVoxel;
    };
    if (options.max_edge.unit == Length::Unit::kVoxel ||
        std::any_of(options.refine.begin(), options.refine.end(), is_in_voxels))
      refuse("max_edge is in voxels, but no image is behind the surface", "give it in mm");
  }
  if (isosurface.has_voxels()) return;
  if (options.method == DecimateMethod::kPaper)
    refuse("method paper looks for the isosurface in its image's voxels, but no image is behind the surface",
           "take method certified");
  if (options.pieces > 1)
    refuse("pieces are cut along an image's planes, but no image is behind the surface", "leave out pieces");
  if (options.edge_per_thickness > 0)
    refuse("edge_per_thickness is measured in an image's voxels, but no image is behind the surface",
           "take max_edge or refine");
}

SimplexMesh decimate_kept(const Isosurface& isosurface, const DecimateOptions& options, Context& context) {
  if (options.method == DecimateMethod::kCertified) {
    const std::uint32_t pieces = options.pieces > 0        ? static_cast<std::uint32_t>(options.pieces)
                                 : isosurface.has_voxels() ? pieces_within(isosurface, context)
                                                           : 1;
    return pieces > 1 ? decimate_certified_in_pieces(isosurface, pieces, options, context)
                      : decimate_certified(isosurface, options, context);
  }
  const double distance_mm = options.distance.in_mm(isosurface.surface.voxel_mm);
  const std::uint64_t seed = options.seed != 0 ? options.seed : context.seed;
  SimplexMesh mesh = options.pieces > 1
                         ? decimate_in_pieces(isosurface, static_cast<std::uint32_t>(options.pieces), options,
                                              distance_mm, seed, context)
                         : decimate_whole(isosurface, options, distance_mm, seed, context);
  PERIOST_ASSERT(check_simplex_mesh(mesh).empty());
  mesh.report.triangles_after = mesh.face.size();
  mesh.report.requested_distance_mm = distance_mm;
  return mesh;
}

}  // namespace

SimplexMesh decimate(const Isosurface& isosurface, const DecimateOptions& options, Context& context) {
  require_voxels(isosurface, options);
  SimplexMesh mesh;
  if (options.small_components == SmallComponents::kDrop && options.small_triangles > 0) {
    const auto least = static_cast<std::size_t>(options.small_triangles);
    Isosurface kept = isosurface;
    drop_small_surfaces(kept, least);
    mesh = decimate_kept(kept, options, context);
    mesh.report.dropped_below = least;
  } else {
    mesh = decimate_kept(isosurface, options, context);
  }
  mesh.report.triangles_before = isosurface.surface.triangles.size();
  return mesh;
}

}  // namespace periost
