#include "stages/decimate/certified_thin.h"

#include <algorithm>
#include <array>
#include <limits>

#include "stages/decimate/certified_patch.h"

namespace periost {
namespace {

constexpr int kPatchRings = 4;         // of triangles; those in the outer two stay as they are
constexpr double kHopeless = 0.5;      // of the least angle: removals that leave a smaller one are not tried
constexpr double kAimOfMending = 1.3;  // least angles
constexpr int kMendingRounds = 4;      // at most, while something moves
constexpr double kDeficitSlack = 1e-12;                     // sums that differ by rounding count as equal
constexpr std::array<double, 2> kPlaceStrengths{0.3, 2.0};  // of the tangential regularisation

// Sum of deficits to the least angle, radians, and how many triangles.
struct PatchState {
  double deficits = 0;
  std::size_t triangles = 0;
};
PatchState examine(const CertifiedState& state, const Patch& patch, double least) {
  PatchState sum;
  for (const Index t : patch.triangles()) {
    sum.deficits += std::max(0.0, least - min_angle(corners_now(state.mesh, t)));
    ++sum.triangles;
  }
  return sum;
}

double worst_angle_after(const CertifiedMesh& mesh, const Proposal& proposal) {
  double worst = std::numeric_limits<double>::max();
  for (const LinkedTriangle& cell : proposal.cells)
    worst = std::min(worst, min_angle(corners_after(mesh, proposal, cell)));
  return worst;
}

// Leaves in worker.proposal a removal that all checks but those on angles let pass.
bool find_removal(CertifiedState& state, Worker& worker, Index t, std::size_t k) {
  const CertifiedMesh& mesh = state.mesh;
  Proposal& proposal = worker.proposal;
  if (!propose_removal(mesh, t, k, proposal) || makes_neck(mesh, proposal)) return false;
  const Vec3 normal = edge_normal(state, proposal.moved, proposal.removed);
  const Vec3 origin = state.reference.points[0];
  Quadric quadric = state.quadrics[proposal.moved];
  quadric += state.quadrics[proposal.removed];
  Vec3 middle;
  for (const Index v : proposal.rim) middle += mesh.points[v] / static_cast<double>(proposal.rim.size());
  const GuardLimits limits = worker.limits;
  worker.limits.growth = std::numeric_limits<double>::max();  // whatever the angles
  bool found = false;
  for (const double strength : kPlaceStrengths) {
    proposal.place = origin + best_place(quadric, middle - origin, normal, strength);
    found = worst_angle_after(mesh, proposal) >= kHopeless * limits.min_angle &&
            check_move(state, worker, normal, 0, FirstAsked::kRing) == Refusal::kNone;
    if (found) break;
  }
  worker.limits = limits;
  return found;
}

void mend(CertifiedState& state, Worker& worker, const Patch& patch) {
  const GuardLimits limits = worker.limits;
  worker.limits.worst_angle_first = true;
  worker.limits.min_angle = kAimOfMending * limits.min_angle;
  const double aim = worker.limits.min_angle;
  for (int round = 0; round < kMendingRounds; ++round) {
    const std::uint64_t before = worker.counts.moves();
    angle_pass(state, worker, patch.free_vertices(), aim);
    if (worker.counts.moves() == before) break;
  }
  worker.limits = limits;
}

// Whether fewer triangles are left.
bool thin_at(CertifiedState& state, Worker& worker, Index t, std::size_t k) {
  if (!find_removal(state, worker, t, k)) return false;
  Patch patch(state, worker, {worker.proposal.moved}, kPatchRings);
  const PatchState before = examine(state, patch, worker.limits.min_angle);
  const std::size_t quota = worker.quota--;
  commit_move(state, worker);
  ++worker.counts.removals;
  mend(state, worker, patch);
  const PatchState after = examine(state, patch, worker.limits.min_angle);
  if (after.triangles < before.triangles && after.deficits <= before.deficits + kDeficitSlack) return true;
  patch.restore();
  worker.quota = quota;
  return false;
}

}  // namespace

void thinning_pass(CertifiedState& state, Worker& worker, const VertexList& vertices,
                   const Context& context) {
  CertifiedMesh& mesh = state.mesh;
  Star star;
  for (const Index v : vertices) {
    if (worker.quota == 0) return;
    context.check_cancelled();
    if (mesh.incident[v] == kNoIndex || mesh.is_locked[v] || !gather_star(mesh, v, star)) continue;
    for (std::size_t i = 0; i < star.triangle.size(); ++i) {
      const Index t = star.triangle[i];
      if (star.link[i] < v || mesh.is_on_contour(star.link[i])) continue;
      if (thin_at(state, worker, t, (mesh.triangles[t].slot_of(v) + 2) % 3)) break;
    }
  }
}

}  // namespace periost
