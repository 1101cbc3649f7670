#include "stages/decimate/certified.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include "pipeline/base/error.h"
#include "pipeline/geometry/self_intersection.h"
#include "pipeline/geometry/simplex_dual.h"
#include "stages/decimate/certified_pieces.h"
#include "stages/decimate/certified_schedule.h"

namespace periost {
namespace {

constexpr double kRounding = 1e-4;    // part of the tolerance kept for rounding
constexpr double kNoticedStep = 0.1;  // tolerances
constexpr int kSheetSide = 4;         // voxels

double tolerance_mm(const Isosurface& isosurface, const DecimateOptions& options) {
  const double voxel = isosurface.frame.largest_spacing();
  if (options.distance.unit == Length::Unit::kVoxel && !(voxel > 0)) {
    throw Error(ErrorKind::kUsage, "decimate.no_voxel",
                "the distance of decimation is in voxels, but no image is behind the surface",
                "state the distance in mm");
  }
  return options.distance.in_mm(voxel);
}

double reverse_scale(ReverseDistance reverse) {
  return reverse == ReverseDistance::kNone ? 0 : reverse == ReverseDistance::kOnce ? 1 : 2;
}

// Where moves look for intersections: where sheets of the isosurface are close to one another, or everywhere.
enum class Watch { kCloseSheets, kEverywhere };

SheetGrid make_sheets(const Reference& reference, const CertifiedMesh& mesh, Watch watch, double tolerance,
                      const Context& context) {
  if (watch == Watch::kEverywhere) return {reference, mesh, kSheetSide};
  return {reference, mesh, kSheetSide, close_sheets(reference, 2 * tolerance, context), tolerance};
}

CertifiedState assemble(const Reference& reference, const Isosurface& isosurface, StateParts parts,
                        const DecimateOptions& options, Watch watch, const Context& context) {
  const double tolerance = tolerance_mm(isosurface, options) * (1 - kRounding);
  parts.mesh.least_step = kNoticedStep * tolerance;
  SheetGrid sheets = make_sheets(reference, parts.mesh, watch, tolerance, context);
  const std::size_t triangles = parts.mesh.triangles.size(), points = parts.mesh.points.size();
  return {reference,
          std::move(parts.mesh),
          std::move(parts.proofs),
          std::move(parts.quadrics),
          std::move(sheets),
          make_size_limits(isosurface, reference, options, context),
          tolerance,
          tolerance * reverse_scale(options.reverse),
          std::vector<std::uint32_t>(3 * triangles, 0),
          std::vector<std::uint32_t>(triangles, 0),
          std::vector<std::uint32_t>(points, 0),
          std::vector<std::uint8_t>(points, 0),
          std::move(parts.contours),
          static_cast<double>(reference.triangles.size()) /
              static_cast<double>(isosurface.surface.triangles.size())};
}

CertifiedState make_state(const Reference& reference, const Isosurface& isosurface,
                          const DecimateOptions& options, Watch watch, const Context& context) {
  StateParts parts{make_certified_mesh(reference),
                   make_reverse_proofs(reference.triangles.size()),
                   make_quadrics(reference),
                   {}};
  parts.contours = make_contours(reference, parts.mesh);
  add_contour_quadrics(reference, parts.mesh, parts.quadrics);
  return assemble(reference, isosurface, std::move(parts), options, watch, context);
}

SurfaceMesh extract_surface(const CertifiedState& state) {
  SurfaceMesh surface;
  surface.voxel_mm = state.reference.voxel_mm;
  std::vector<Index> number(state.mesh.points.size(), kNoIndex);
  auto& blocked = surface.point_fields["blocked_by"];
  for (Index v = 0; v < state.mesh.points.size(); ++v) {
    if (state.mesh.incident[v] == kNoIndex) continue;
    number[v] = static_cast<Index>(surface.points.size());
    surface.points.push_back(state.mesh.points[v]);
    blocked.push_back(static_cast<float>(state.blocked_by[v]));
  }
  for (const auto& t : state.mesh.triangles) {
    if (t.is_alive())
      surface.triangles.push_back({number[t.corner[0]], number[t.corner[1]], number[t.corner[2]]});
  }
  return surface;
}

DecimationReport make_report(const MoveCounts& counts, const Isosurface& isosurface,
                             const DecimateOptions& options, std::size_t after) {
  const auto refused = [&](Refusal r) { return counts.refused[static_cast<std::size_t>(r)]; };
  DecimationReport report;
  report.triangles_before = isosurface.surface.triangles.size();
  report.triangles_after = after;
  report.removals = counts.removals;
  report.insertions = counts.insertions;
  report.swaps = counts.swaps;
  report.relocations = counts.relocations;
  report.requested_distance_mm = tolerance_mm(isosurface, options);
  report.rejected_link = refused(Refusal::kLink);
  report.rejected_topology = refused(Refusal::kTopology);
  report.rejected_barycentric = refused(Refusal::kBarycentric);
  report.rejected_angle = refused(Refusal::kAngle);
  report.rejected_fold = refused(Refusal::kFold);
  report.rejected_distance = refused(Refusal::kDistance);
  report.rejected_reverse = refused(Refusal::kReverse);
  report.rejected_self_intersection = refused(Refusal::kSelfIntersection);
  return report;
}

// Where the result intersects itself though the isosurface does not.
std::optional<Vec3> find_intersection(const SurfaceMesh& result, const Isosurface& isosurface,
                                      const Context& context) {
  const auto pairs = self_intersections(result, context, 1);
  if (pairs.empty() || !self_intersections(isosurface.surface, context, 1).empty()) return std::nullopt;
  return result.points[result.triangles[pairs[0].first][0]];
}

void require_no_intersection(const SurfaceMesh& result, const Isosurface& isosurface,
                             const Context& context) {
  const auto place = find_intersection(result, isosurface, context);
  if (!place) return;
  char where[96];
  std::snprintf(where, sizeof where, "(%.2f, %.2f, %.2f) mm", place->x, place->y, place->z);
  throw Error(ErrorKind::kQuality, "decimate.self_intersection",
              std::string("the decimated surface intersects itself at ") + where,
              "a smaller distance keeps near sheets apart");
}

SimplexMesh with_report(const SurfaceMesh& surface, const MoveCounts& counts, const Isosurface& isosurface,
                        const DecimateOptions& options) {
  SimplexMesh mesh = dual_simplex_mesh(surface);
  mesh.report = make_report(counts, isosurface, options, surface.triangles.size());
  return mesh;
}

}  // namespace

CertifiedState assemble_state(const Reference& reference, const Isosurface& isosurface, StateParts parts,
                              const DecimateOptions& options, const Context& context) {
  return assemble(reference, isosurface, std::move(parts), options, Watch::kEverywhere, context);
}

CertifiedState make_certified_state(const Reference& reference, const Isosurface& isosurface,
                                    const DecimateOptions& options, const Context& context) {
  return make_state(reference, isosurface, options, Watch::kEverywhere, context);
}

SimplexMesh finish_certified(const SurfaceMesh& surface, const MoveCounts& counts,
                             const Isosurface& isosurface, const DecimateOptions& options,
                             const Context& context) {
  require_no_intersection(surface, isosurface, context);
  return with_report(surface, counts, isosurface, options);
}

SimplexMesh decimate_certified(const Isosurface& isosurface, const DecimateOptions& options,
                               Context& context) {
  const Reference reference(isosurface, nullptr, context);
  MoveCounts counts;
  const auto decimate = [&](Watch watch) {
    CertifiedState state = make_state(reference, isosurface, options, watch, context);
    counts = run_certified_schedule(state, options, Extent::kToTheEnd, context);
    return extract_surface(state);
  };
  const SurfaceMesh surface = decimate(Watch::kCloseSheets);
  if (!find_intersection(surface, isosurface, context)) {
    return with_report(surface, counts, isosurface, options);
  }
  context.debug("decimate.again",
                "the surface meets itself where its sheets seemed far apart: again, watched");
  return finish_certified(decimate(Watch::kEverywhere), counts, isosurface, options, context);
}

}  // namespace periost
