#include "stages/decimate/certified_pieces.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "pipeline/base/error.h"
#include "pipeline/base/quantity.h"
#include "pipeline/base/random.h"
#include "pipeline/geometry/topology.h"
#include "stages/decimate/certified_bands.h"
#include "stages/decimate/certified_schedule.h"

namespace periost {
namespace {

constexpr double kOnCut = 1e-6;  // voxels

// Locks the cut contours of a piece, whose quadrics are then the surface's alone.
void lock_cuts(const CutPlanes& planes, CertifiedState& state) {
  CertifiedMesh& mesh = state.mesh;
  const auto axis = static_cast<std::size_t>(planes.axis);
  for (Index v = 0; v < mesh.points.size(); ++v) {
    if (!mesh.is_on_contour(v)) continue;
    const double q = state.reference.frame().to_index(mesh.points[v])[axis];
    const bool is_cut = std::any_of(planes.at.begin(), planes.at.end(),
                                    [&](std::int32_t c) { return std::abs(q - c) < kOnCut; });
    if (!is_cut) continue;
    mesh.is_locked[v] = 1;
    state.quadrics[v] = {};
  }
  for (Index t = 0; t < state.reference.triangles.size(); ++t) {
    const auto c = state.reference.corners(t);
    Quadric plane;
    plane.add_plane(state.reference.normals[t], c[0] - state.reference.points[0],
                    norm(cross(c[1] - c[0], c[2] - c[0])) / 6);
    for (const Index v : state.reference.triangles[t].corner) {
      if (mesh.is_locked[v] && mesh.is_on_contour(v)) state.quadrics[v] += plane;
    }
  }
}

void unbound(CertifiedContours& contours) {
  const CertifiedContours none;
  contours.lo = none.lo;
  contours.hi = none.hi;
}

// Bounds a piece by its cuts, so that it does not reach into others.
void keep_between_cuts(const CutPlanes& planes, std::size_t part, CertifiedContours& contours) {
  const auto axis = static_cast<std::size_t>(planes.axis);
  if (part > 0) contours.cut_lo[axis] = planes.at[part - 1];
  if (part < planes.at.size()) contours.cut_hi[axis] = planes.at[part];
  contours.lo[axis] = std::max(contours.lo[axis], contours.cut_lo[axis]);
  contours.hi[axis] = std::min(contours.hi[axis], contours.cut_hi[axis]);
}

// Triangles at locked vertices and their neighbours, about which nothing moves.
std::size_t frozen_triangles(const CertifiedMesh& mesh) {
  std::vector<std::uint8_t> is_frozen = mesh.is_locked;
  for (const LinkedTriangle& t : mesh.triangles) {
    if (!t.is_alive()) continue;
    const auto& c = t.corner;
    if (mesh.is_locked[c[0]] || mesh.is_locked[c[1]] || mesh.is_locked[c[2]])
      is_frozen[c[0]] = is_frozen[c[1]] = is_frozen[c[2]] = 1;
  }
  return static_cast<std::size_t>(
      std::count_if(mesh.triangles.begin(), mesh.triangles.end(), [&](const LinkedTriangle& t) {
        return t.is_alive() && (is_frozen[t.corner[0]] || is_frozen[t.corner[1]] || is_frozen[t.corner[2]]);
      }));
}

DecimatedPiece decimate_piece(const Isosurface& isosurface, const SlabPlan& plan, std::size_t part,
                              DecimateOptions options, const Context& context,
                              std::vector<ReverseProof>& proofs) {
  const int axis = plan.planes.axis;
  std::vector<Index> order;
  std::optional<Reference> reference;
  {
    const Isosurface piece = cut_slab(isosurface, axis, plan.pieces[part]);
    if (piece.surface.triangles.empty()) return {};
    reference.emplace(piece, &order);
  }
  std::vector<Index> whole = triangles_of_slab(isosurface, axis, plan.pieces[part]);
  PERIOST_ASSERT(whole.size() == order.size());
  for (Index& t : order) t = whole[t];
  whole = std::move(order);

  CertifiedState state = make_certified_state(*reference, isosurface, options, context);
  lock_cuts(plan.planes, state);
  if (options.max_triangles > 0) {  // what is dense at the cuts is left to the next phase
    const double share =
        static_cast<double>(whole.size()) / static_cast<double>(isosurface.surface.triangles.size());
    options.max_triangles = static_cast<std::size_t>(share * static_cast<double>(options.max_triangles)) +
                            frozen_triangles(state.mesh) + 1;
  }
  // Cuts of a closed surface meet the border planes of the image, but do not run along them.
  if (!isosurface.is_open) unbound(state.contours);
  const Vec3 lo = state.contours.lo, hi = state.contours.hi;
  keep_between_cuts(plan.planes, part, state.contours);
  // Contours of an open surface are decimated in this phase only.
  const Extent extent = isosurface.is_open ? Extent::kToTheEnd : Extent::kByCost;
  const MoveCounts counts = run_certified_schedule(state, options, extent, context);
  DecimatedPiece piece = take_piece(state, whole, isosurface.surface.points[0], proofs);
  piece.counts = counts;
  piece.lo = lo;
  piece.hi = hi;
  return piece;
}

// The numbers below `count` in ascending order, or shuffled if `seed` is not 0.
std::vector<std::size_t> order_of(std::size_t count, std::uint64_t seed) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  Random random(seed, count);
  for (std::size_t i = count; i > 1 && seed != 0; --i)
    std::swap(order[i - 1], order[random.below(static_cast<std::uint32_t>(i))]);
  return order;
}

JoinedMesh decimate_pieces(const Isosurface& isosurface, const SlabPlan& plan, std::uint64_t order_seed,
                           const DecimateOptions& options, const Context& context) {
  JoinedMesh joined;
  if (options.reverse != ReverseDistance::kNone) joined.proofs.resize(isosurface.surface.triangles.size());
  // Pieces are joined in their order, as soon as those before them are.
  std::vector<std::optional<DecimatedPiece>> waiting(plan.pieces.size());
  PieceJoiner joiner(joined);
  std::size_t next = 0;
  for (const std::size_t part : order_of(waiting.size(), order_seed)) {
    waiting[part] = decimate_piece(isosurface, plan, part, options, context, joined.proofs);
    for (; next < waiting.size() && waiting[next]; ++next) {
      joiner.add(*waiting[next], triangles_of_slab(isosurface, plan.planes.axis, plan.pieces[next]));
      waiting[next].reset();
    }
  }
  return joined;
}

// Measured on a skull of 534,714 triangles: the program itself; per triangle of the isosurface, what is kept
// of pieces and for bands; per triangle of a piece, its working state.
constexpr double kProgramBytes = 21 * double{kMiB}, kKeptBytes = 54, kWorkingBytes = 320;
constexpr int kLeastPieceVoxels = 16;  // along the longest side of the image

double bytes_of(const Isosurface& isosurface) {
  return static_cast<double>(sizeof(Vec3) * isosurface.surface.points.size() +
                             sizeof(Triangle) * isosurface.surface.triangles.size() +
                             sizeof(CellBlock) * isosurface.blocks.size() +
                             sizeof(Index) * isosurface.block_table.size());
}

}  // namespace

std::uint32_t pieces_within(const Isosurface& isosurface, const Context& context) {
  if (context.memory_bytes == 0) return 1;
  const auto triangles = static_cast<double>(isosurface.surface.triangles.size());
  const auto& dims = isosurface.frame.dims;
  const double budget = static_cast<double>(context.memory_bytes);
  const double fixed = kProgramBytes + bytes_of(isosurface), working = kWorkingBytes * triangles;
  if (fixed + working <= budget) return 1;
  const double kept = fixed + kKeptBytes * triangles;
  const int most = std::max(2, *std::max_element(dims.begin(), dims.end()) / kLeastPieceVoxels);
  const double pieces = std::max(2.0, std::ceil(working / std::max(1.0, budget - kept)));
  if (pieces <= most) return static_cast<std::uint32_t>(pieces);
  throw Error(
      ErrorKind::kLimit, "limit.memory",
      fmt::format(
          "decimating {} triangles needs more than the {:.0f} MiB that --memory allows, even in {} pieces",
          isosurface.surface.triangles.size(), budget / static_cast<double>(kMiB), most),
      fmt::format("allow at least --memory {:.0f}MiB",
                  std::ceil((kept + working / most) / static_cast<double>(kMiB))));
}

SimplexMesh decimate_certified_in_pieces(const Isosurface& isosurface, std::uint32_t pieces,
                                         const DecimateOptions& options, Context& context,
                                         std::uint64_t order_seed) {
  const SlabPlan plan = plan_slabs(isosurface, pieces);
  const int axis = plan.planes.axis;
  context.info("decimate.pieces", fmt::format("cut across axis {} at the voxels {}", "ijk"[axis],
                                              fmt::join(plan.planes.at, ", ")));
  JoinedMesh joined = decimate_pieces(isosurface, plan, order_seed, options, context);
  for (const std::vector<Slab>& slabs : {plan.shifted, plan.bands, plan.seams}) {
    decimate_slabs(isosurface, axis, slabs, order_of(slabs.size(), order_seed), options, context, joined);
  }
  SimplexMesh mesh = finish_certified(surface_of(joined, isosurface.frame.largest_spacing()), joined.counts,
                                      isosurface, options, context);
  mesh.report.pieces = static_cast<std::uint32_t>(plan.pieces.size());
  return mesh;
}

}  // namespace periost
