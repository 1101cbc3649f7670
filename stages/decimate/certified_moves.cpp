#include "stages/decimate/certified_moves.h"

#include <algorithm>

namespace periost {
namespace {

constexpr std::array<double, 3> kStrengths{0.05, 0.3, 2.0};  // of the tangential regularisation, in turn
constexpr double kLengthWeight = 1e-3;                       // of the squared length in the cost
constexpr double kGainSlack = 1e-4;                          // radians: smaller gains do not count

// The triangles that share a vertex with the ring but are not in it.
void collect_around(const CertifiedMesh& mesh, const Proposal& proposal, SheetScratch& scratch,
                    std::vector<Index>& around) {
  if (scratch.stamp.size() < mesh.triangles.size()) scratch.stamp.resize(mesh.triangles.size(), 0);
  const std::uint32_t tick = ++scratch.tick;
  around.clear();
  for (const Index t : proposal.before) scratch.stamp[t] = tick;
  for (const Index v : proposal.rim) {
    const Index first = mesh.incident[v];
    Index t = first;
    do {
      const LinkedTriangle& triangle = mesh.triangles[t];
      if (scratch.stamp[t] != tick) {
        scratch.stamp[t] = tick;
        around.push_back(t);
      }
      t = triangle.across[(triangle.slot_of(v) + 1) % 3];
    } while (t != first && t != kNoIndex);
  }
}

bool is_in_region(const CertifiedState& state, const Worker& worker, Vec3 place) {
  const Vec3 q = state.reference.frame().to_index(place);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!(q[axis] > worker.region_lo[axis] && q[axis] < worker.region_hi[axis])) return false;
  }
  return true;
}

// Finds the isosurface triangle at the moved vertex; false when there is none within the tolerance.
bool locate(const CertifiedState& state, const Worker& worker, Proposal& proposal, Vec3 facing) {
  if (proposal.moved == kNoIndex) return true;
  if (!is_finite(proposal.place) || !is_in_region(state, worker, proposal.place)) return false;
  proposal.place_nearest = state.reference.nearest(proposal.place, state.tolerance, facing).triangle;
  return proposal.place_nearest != kNoIndex;
}

bool is_forward_certified(const CertifiedState& state, Worker& worker) {
  const Proposal& proposal = worker.proposal;
  for (const LinkedTriangle& cell : proposal.cells) {
    DualTriangle triangle{};
    for (std::size_t k = 0; k < 3; ++k) {
      triangle.corner[k] = proposal.point_of(state.mesh, cell.corner[k]);
      triangle.nearest[k] = proposal.nearest_of(state.mesh, cell.corner[k]);
    }
    if (!certify_forward(state.reference, triangle, state.tolerance, worker.forward)) return false;
  }
  return true;
}

// All criteria but link, topology and angles, cheap ones first.
Refusal check(CertifiedState& state, Worker& worker, Vec3 facing, bool mends_angles) {
  Proposal& proposal = worker.proposal;
  if (!locate(state, worker, proposal, facing)) return Refusal::kDistance;
  if (!meets_fold(state.reference, state.mesh, proposal, state.limits)) return Refusal::kFold;
  if (!mends_angles && !meets_barycentric(state.mesh, proposal, state.limits)) return Refusal::kBarycentric;
  if (!is_forward_certified(state, worker)) return Refusal::kDistance;
  collect_around(state.mesh, proposal, worker.sheets, worker.around);
  if (state.reverse_tolerance > 0 &&
      !certify_reverse(state.reference, state.mesh, state.proofs, proposal, worker.around,
                       state.reverse_tolerance, worker.reverse)) {
    return Refusal::kReverse;
  }
  if (state.sheets.would_intersect(state.mesh, proposal, worker.around, worker.sheets)) {
    return Refusal::kSelfIntersection;
  }
  return Refusal::kNone;
}

// Topology and the rest for a removal whose angles hold.
Refusal check_removal(CertifiedState& state, Worker& worker, Vec3 facing, double gain) {
  const bool mends = gain > kGainSlack;
  if (!meets_topology(state.mesh, worker.proposal, state.limits, mends)) return Refusal::kTopology;
  return check(state, worker, facing, mends);
}

void commit(CertifiedState& state, Worker& worker) {
  const Proposal& proposal = worker.proposal;
  apply(proposal, state.mesh);
  if (state.reverse_tolerance > 0) commit_reverse(proposal, worker.reverse, state.proofs);
  if (proposal.removed != kNoIndex) {
    state.quadrics[proposal.moved] += state.quadrics[proposal.removed];
  }
  state.sheets.insert(state.mesh, proposal);
}

bool refuse(CertifiedState& state, Worker& worker, Refusal refusal, Index vertex) {
  ++worker.counts.refused[static_cast<std::size_t>(refusal)];
  state.blocked_by[vertex] = static_cast<std::uint8_t>(refusal);
  return false;
}

Vec3 edge_normal(const CertifiedState& state, Index u, Index v) {
  return normalized(state.reference.normals[state.mesh.nearest[u]] +
                    state.reference.normals[state.mesh.nearest[v]]);
}

Vec3 rim_centroid(const CertifiedMesh& mesh, const Proposal& proposal) {
  Vec3 sum;
  for (const Index v : proposal.rim) sum += mesh.points[v];
  return sum / static_cast<double>(proposal.rim.size());
}

// Sums the versions of all vertices concerned: unchanged only if none has changed.
std::uint32_t signature_of(const CertifiedMesh& mesh, const Proposal& proposal) {
  std::uint32_t sum = mesh.version[proposal.moved] + mesh.version[proposal.removed];
  for (const Index v : proposal.rim) sum += mesh.version[v];
  return sum;
}

// The place for a removal whose angles hold, if one of the strengths gives one.
Refusal place_merged(const CertifiedState& state, Proposal& proposal, Vec3 normal, double& gain) {
  Quadric quadric = state.quadrics[proposal.moved];
  quadric += state.quadrics[proposal.removed];
  const Vec3 origin = state.reference.points[0];
  const Vec3 towards = rim_centroid(state.mesh, proposal) - origin;
  for (const double strength : kStrengths) {
    proposal.place = origin + best_place(quadric, towards, normal, strength);
    if (meets_angles(state.mesh, proposal, state.limits, &gain)) return Refusal::kNone;
  }
  return Refusal::kAngle;
}

}  // namespace

MoveCounts& MoveCounts::operator+=(const MoveCounts& other) {
  removals += other.removals;
  swaps += other.swaps;
  relocations += other.relocations;
  for (std::size_t i = 0; i < refused.size(); ++i) refused[i] += other.refused[i];
  return *this;
}

int topological_difference(const CertifiedMesh& mesh, Index t, std::size_t k) {
  const LinkedTriangle& cell = mesh.triangles[t];
  const Index u = cell.corner[(k + 1) % 3], v = cell.corner[(k + 2) % 3];
  const LinkedTriangle& other = mesh.triangles[cell.across[k]];
  const Index opposite = other.corner[3 - other.slot_of(u) - other.slot_of(v)];
  return mesh.valence[u] + mesh.valence[v] - mesh.valence[cell.corner[k]] - mesh.valence[opposite];
}

double removal_cost(const CertifiedState& state, Index u, Index v) {
  Quadric quadric = state.quadrics[u];
  quadric += state.quadrics[v];
  const Vec3 origin = state.reference.points[0];
  const Vec3 pu = state.mesh.points[u] - origin, pv = state.mesh.points[v] - origin;
  const Vec3 place = best_place(quadric, (pu + pv) * 0.5, edge_normal(state, u, v), kStrengths[0]);
  return std::max(0.0, quadric.at(place)) + kLengthWeight * quadric.trace() * squared_norm(pu - pv);
}

bool try_removal(CertifiedState& state, Worker& worker, Index t, std::size_t k) {
  const LinkedTriangle& cell = state.mesh.triangles[t];
  const Index u = cell.corner[(k + 1) % 3], v = cell.corner[(k + 2) % 3];
  Proposal& proposal = worker.proposal;
  if (!propose_removal(state.mesh, t, k, proposal)) return refuse(state, worker, Refusal::kLink, u);
  const std::uint32_t signature = signature_of(state.mesh, proposal);
  const Index other = cell.across[k];
  const LinkedTriangle& twin = state.mesh.triangles[other];
  const std::size_t slot =
      t < other ? 3 * std::size_t{t} + k : 3 * std::size_t{other} + 3 - twin.slot_of(u) - twin.slot_of(v);
  if (state.failed[slot] == signature) return false;
  const Vec3 normal = edge_normal(state, u, v);
  double gain = 0;
  Refusal refusal = place_merged(state, proposal, normal, gain);
  if (refusal == Refusal::kNone) refusal = check_removal(state, worker, normal, gain);
  if (refusal != Refusal::kNone) {
    state.failed[slot] = signature;
    return refuse(state, worker, refusal, u);
  }
  commit(state, worker);
  ++worker.counts.removals;
  return true;
}

bool try_mending_removal(CertifiedState& state, Worker& worker, Index t, std::size_t k) {
  Proposal& proposal = worker.proposal;
  if (!propose_removal(state.mesh, t, k, proposal)) return false;
  const Vec3 a = state.mesh.points[proposal.moved], b = state.mesh.points[proposal.removed];
  const Vec3 normal = edge_normal(state, proposal.moved, proposal.removed);
  for (const Vec3& place : {(a + b) * 0.5, a, b, rim_centroid(state.mesh, proposal)}) {
    proposal.place = place;
    double gain = 0;
    if (!meets_angles(state.mesh, proposal, state.limits, &gain) || gain < kGainSlack) continue;
    if (check_removal(state, worker, normal, gain) != Refusal::kNone) continue;
    commit(state, worker);
    ++worker.counts.removals;
    return true;
  }
  return false;
}

bool try_swap(CertifiedState& state, Worker& worker, Index t, std::size_t k, bool improve_angles) {
  const LinkedTriangle& cell = state.mesh.triangles[t];
  if (cell.across[k] == kNoIndex) return false;
  if (!improve_angles && topological_difference(state.mesh, t, k) <= 2) return false;
  Proposal& proposal = worker.proposal;
  const Index u = cell.corner[(k + 1) % 3];
  if (!propose_swap(state.mesh, t, k, proposal)) return refuse(state, worker, Refusal::kLink, u);
  double gain = 0;
  Refusal refusal =
      meets_angles(state.mesh, proposal, state.limits, &gain) ? Refusal::kNone : Refusal::kAngle;
  if (improve_angles && gain < kGainSlack) return false;
  const bool mends = gain > kGainSlack;
  if (refusal == Refusal::kNone && !meets_topology(state.mesh, proposal, state.limits, mends)) {
    refusal = Refusal::kTopology;
  }
  if (refusal == Refusal::kNone) refusal = check(state, worker, {}, mends);
  if (refusal != Refusal::kNone) return refuse(state, worker, refusal, u);
  commit(state, worker);
  ++worker.counts.swaps;
  return true;
}

bool try_relocation(CertifiedState& state, Worker& worker, Index vertex, Vec3 place, bool improve_angles) {
  Proposal& proposal = worker.proposal;
  if (!propose_relocation(state.mesh, vertex, proposal)) return false;
  proposal.place = place;
  double gain = 0;
  if (!meets_angles(state.mesh, proposal, state.limits, &gain)) return false;
  if (improve_angles && gain < kGainSlack) return false;
  const Vec3 facing = state.reference.normals[state.mesh.nearest[vertex]];
  if (check(state, worker, facing, gain > kGainSlack) != Refusal::kNone) return false;
  commit(state, worker);
  ++worker.counts.relocations;
  return true;
}

}  // namespace periost
