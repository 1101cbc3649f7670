#include "stages/decimate/certified.h"

#include <algorithm>
#include <cstdio>
#include <limits>

#include "pipeline/base/error.h"
#include "pipeline/geometry/self_intersection.h"
#include "pipeline/geometry/simplex_dual.h"
#include "stages/decimate/certified_passes.h"

namespace periost {
namespace {

constexpr double kRounding = 1e-4;        // part of the tolerance kept for rounding
constexpr std::size_t kRangeSize = 1000;  // living vertices of one queue
constexpr int kSheetSide = 2;             // voxels
constexpr int kStages = 6;                // removal stages by cost
constexpr int kFinalRounds = 8;           // relocations and removals after the last stage
constexpr double kWorthwhile = 0.005;     // part of the vertices a final round must remove to go on
constexpr int kAngleRounds = 3;
constexpr int kSliverRounds = 8;
// While edges are removed, |D| may exceed the limit by this much; swaps bring it down again at the end. At
// the limit itself removals would stop at twice the triangles.
constexpr int kTopologySlack = 3;

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

// Drops the components with fewer triangles than asked.
void drop_small_components(std::size_t least, CertifiedMesh& mesh, ReverseProofs& proofs) {
  const Index count = static_cast<Index>(mesh.triangles.size());
  std::vector<std::uint8_t> seen(count, 0);
  std::vector<Index> component;
  for (Index start = 0; start < count; ++start) {
    if (seen[start]) continue;
    component.assign(1, start);
    seen[start] = 1;
    for (std::size_t head = 0; head < component.size(); ++head) {
      for (const Index next : mesh.triangles[component[head]].across) {
        if (next == kNoIndex || seen[next]) continue;
        seen[next] = 1;
        component.push_back(next);
      }
    }
    if (component.size() >= least) continue;
    for (const Index t : component) {
      for (const Index v : mesh.triangles[t].corner) mesh.incident[v] = kNoIndex;
    }
    for (const Index t : component) {
      mesh.triangles[t].corner[0] = kNoIndex;
      proofs.proof[t].home = kNoIndex;
      proofs.first[t] = kNoIndex;
    }
  }
}

std::size_t living_triangles(const CertifiedMesh& mesh) {
  std::size_t count = 0;
  for (const auto& t : mesh.triangles) count += t.is_alive() ? 1 : 0;
  return count;
}

CertifiedState make_state(const Reference& reference, const Isosurface& isosurface,
                          const DecimateOptions& options) {
  CertifiedMesh mesh = make_certified_mesh(reference);
  ReverseProofs proofs = make_reverse_proofs(reference.triangles.size());
  if (options.small_components == SmallComponents::kDrop && options.small_triangles > 0) {
    drop_small_components(static_cast<std::size_t>(options.small_triangles), mesh, proofs);
  }
  GuardLimits limits;
  limits.min_angle = options.min_angle.radians();
  limits.min_barycentric = options.min_barycentric;
  limits.topology = options.topology + kTopologySlack;
  const double tolerance = tolerance_mm(isosurface, options) * (1 - kRounding);
  SheetGrid sheets(reference, mesh, kSheetSide);
  return {reference,
          std::move(mesh),
          std::move(proofs),
          make_quadrics(reference),
          std::move(sheets),
          limits,
          tolerance,
          tolerance * reverse_scale(options.reverse),
          std::vector<std::uint32_t>(3 * reference.triangles.size(), 0),
          std::vector<std::uint8_t>(reference.points.size(), 0)};
}

// Runs a pass over all ranges.
template <class Pass>
void sweep(CertifiedState& state, Worker& worker, const Context& context, Pass&& pass) {
  for (const VertexRange& range : vertex_ranges(state.mesh, kRangeSize)) {
    context.check_cancelled();
    pass(state, worker, range);
  }
}

void run_schedule(CertifiedState& state, Worker& worker, const Context& context) {
  Progress progress(context, "decimating", kStages + kFinalRounds + kAngleRounds + 1);
  const auto remove_up_to = [&](double limit) {
    sweep(state, worker, context,
          [limit](CertifiedState& s, Worker& w, VertexRange range) { removal_pass(s, w, range, limit); });
    progress.step();
  };
  const auto report = [&](const char* what) {
    context.debug("decimate.stage",
                  std::string(what) + ": " + std::to_string(living_triangles(state.mesh)) + " triangles");
  };
  sweep(state, worker, context, swap_pass);
  for (int stage = 0; stage < kStages; ++stage) {
    remove_up_to(median_removal_cost(state));
    report("stage");
  }
  for (int round = 0; round < kFinalRounds; ++round) {
    const std::uint64_t before = worker.counts.removals;
    remove_up_to(std::numeric_limits<double>::max());
    report("final removals");
    const std::uint64_t removed = worker.counts.removals - before;
    const std::size_t left = living_triangles(state.mesh);
    sweep(state, worker, context, relocation_pass);
    report("relocations");
    if (static_cast<double>(removed) < kWorthwhile * static_cast<double>(left)) break;
  }
  for (int round = 0; round < kAngleRounds; ++round) {
    sweep(state, worker, context, angle_pass);
    progress.step();
    report("angles");
  }
  sweep(state, worker, context, fit_pass);
  state.limits.topology -= kTopologySlack;
  sweep(state, worker, context, swap_pass);
  state.limits.worst_angle_first = true;
  for (int round = 0; round < kSliverRounds; ++round) sweep(state, worker, context, sliver_pass);
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

void require_no_intersection(const SurfaceMesh& result, const Isosurface& isosurface,
                             const Context& context) {
  const auto pairs = self_intersections(result, context, 1);
  if (pairs.empty() || !self_intersections(isosurface.surface, context, 1).empty()) return;
  const Vec3 place = result.points[result.triangles[pairs[0].first][0]];
  char where[96];
  std::snprintf(where, sizeof where, "(%.2f, %.2f, %.2f) mm", place.x, place.y, place.z);
  throw Error(ErrorKind::kQuality, "decimate.self_intersection",
              std::string("the decimated surface intersects itself at ") + where,
              "a smaller distance keeps near sheets apart");
}

}  // namespace

SimplexMesh decimate_certified(const Isosurface& isosurface, const DecimateOptions& options,
                               Context& context) {
  const Reference reference(isosurface);
  CertifiedState state = make_state(reference, isosurface, options);
  Worker worker;
  run_schedule(state, worker, context);
  const SurfaceMesh surface = extract_surface(state);
  require_no_intersection(surface, isosurface, context);
  SimplexMesh mesh = dual_simplex_mesh(surface);
  mesh.report = make_report(worker.counts, isosurface, options, surface.triangles.size());
  return mesh;
}

}  // namespace periost
