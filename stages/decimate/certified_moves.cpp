#include "stages/decimate/certified_moves.h"

#include <algorithm>

#include "stages/decimate/certified_contour_moves.h"
#include "stages/decimate/certified_seek.h"

namespace periost {
namespace {

constexpr std::array<double, 3> kStrengths{0.05, 0.3, 2.0};  // of the tangential regularisation, in turn
constexpr double kLengthWeight = 1e-3;                       // of the squared length in the cost
// Where an angle is only aimed for, smaller gains than this are not worth a check, radians.
constexpr double kWorthwhileGain = 0.03;
// Fall of the sum of deficits' fourth powers for which two more triangles may be made: half a degree's.
constexpr double kLeastInsertionGain = 1e-8;
// Steps along the normal, in tolerances and away from the rim, that are tried where a place is too far from
// the isosurface or leaves it too far away: the triangles of a bent part lie on one side of it, so its
// vertices belong on the other.
constexpr std::array<double, 2> kHeights{0.2, 0.4};
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

// Inner vertices do not come to border planes where contours are, nor any to the planes of a cut.
bool is_in_region(const CertifiedState& state, const Worker& worker, Vec3 place, bool is_on_contour) {
  const Vec3 q = state.reference.frame().to_index(place);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!(q[axis] > worker.region_lo[axis] && q[axis] < worker.region_hi[axis])) return false;
    const CertifiedContours& contours = state.contours;
    if (is_on_contour ? !(q[axis] > contours.cut_lo[axis] && q[axis] < contours.cut_hi[axis])
                      : !(q[axis] > contours.lo[axis] && q[axis] < contours.hi[axis])) {
      return false;
    }
  }
  return true;
}

// Finds the isosurface triangle at the moved vertex; false when there is none within the tolerance.
bool locate(const CertifiedState& state, const Worker& worker, Proposal& proposal, Vec3 facing) {
  if (proposal.moved == kNoIndex) return true;
  if (!is_finite(proposal.place) ||
      !is_in_region(state, worker, proposal.place, state.mesh.is_on_contour(proposal.moved)))
    return false;
  proposal.place_nearest = state.reference.nearest(proposal.place, state.tolerance, facing).triangle;
  return proposal.place_nearest != kNoIndex;
}

// By the overlay of the whole ring or, where that cannot be made, triangle by triangle.
bool is_forward_certified(const CertifiedState& state, Worker& worker, FirstAsked asked) {
  std::uint32_t proved = 0;
  if (asked == FirstAsked::kRing) {
    const Answer ring = certify_ring(state.reference, state.mesh, worker.proposal, state.tolerance,
                                     worker.forward, worker.ring);
    if (ring != Answer::kUnknown) return ring == Answer::kProved;
    proved = worker.ring.unproved;
  }
  const Proposal& proposal = worker.proposal;
  for (std::size_t j = 0; j < proposal.cells.size(); ++j) {
    if (j < kMaxFan && (proved >> j & 1u) != 0) continue;
    const DualTriangle triangle = dual_triangle(state.mesh, proposal, proposal.cells[j]);
    if (!certify_forward(state.reference, triangle, state.tolerance, worker.forward)) return false;
  }
  return true;
}

// All criteria but link, topology and angles, cheap ones first.
Refusal check(CertifiedState& state, Worker& worker, Vec3 facing, bool mends_angles, FirstAsked asked) {
  Proposal& proposal = worker.proposal;
  if (!locate(state, worker, proposal, facing)) return Refusal::kDistance;
  state.sheets.approach(state.mesh, proposal, worker.sheets);
  if (!meets_sizes(state.sizes, state.mesh, proposal)) return Refusal::kSize;
  if (!meets_fold(state.reference, state.mesh, proposal, worker.limits)) return Refusal::kFold;
  if (!mends_angles && !meets_barycentric(state.mesh, proposal, worker.limits)) return Refusal::kBarycentric;
  if (!is_forward_certified(state, worker, asked)) return Refusal::kDistance;
  collect_around(state.mesh, proposal, worker.sheets, worker.around);
  if (state.reverse_tolerance > 0 &&
      !certify_reverse(state.reference, state.mesh, state.proofs, proposal, worker.around,
                       asked == FirstAsked::kRing && worker.ring.is_complete ? &worker.ring : nullptr,
                       state.reverse_tolerance, worker.reverse)) {
    return Refusal::kReverse;
  }
  if (state.sheets.would_intersect(state.mesh, proposal, worker.around, worker.sheets)) {
    return Refusal::kSelfIntersection;
  }
  return Refusal::kNone;
}

FirstAsked first_asked(bool improve_angles) {
  return improve_angles ? FirstAsked::kTriangles : FirstAsked::kRing;
}

Vec3 rim_centroid(const CertifiedMesh& mesh, const Proposal& proposal) {
  Vec3 sum;
  for (const Index v : proposal.rim) sum += mesh.points[v];
  return sum / static_cast<double>(proposal.rim.size());
}

// The place for a removal whose angles hold: one of the strengths gives it, or a search along the surface.
Refusal place_merged(const CertifiedState& state, Worker& worker, Vec3 normal, double& gain) {
  Proposal& proposal = worker.proposal;
  Quadric quadric = state.quadrics[proposal.moved];
  quadric += state.quadrics[proposal.removed];
  const Vec3 origin = state.reference.points[0];
  const Vec3 towards = rim_centroid(state.mesh, proposal) - origin;
  for (const double strength : kStrengths) {
    proposal.place = origin + best_place(quadric, towards, normal, strength);
    if (meets_angles(state.mesh, proposal, worker.limits, &gain)) return Refusal::kNone;
  }
  if (!seek_angles(state.mesh, worker.limits, quadric, origin, normal, proposal)) return Refusal::kAngle;
  meets_angles(state.mesh, proposal, worker.limits, &gain);
  return Refusal::kNone;
}

// Topology and the rest for a removal, at its place and a little above and below.
Refusal check_at_heights(CertifiedState& state, Worker& worker, Vec3 normal, double gain) {
  Refusal refusal = check_move(state, worker, normal, gain, FirstAsked::kRing);
  const Vec3 place = worker.proposal.place;
  const double side = dot(place - rim_centroid(state.mesh, worker.proposal), normal) > 0 ? 1 : -1;
  for (const double height : kHeights) {
    if (!worker.is_thorough) break;
    if (refusal != Refusal::kDistance && refusal != Refusal::kReverse) break;
    worker.proposal.place = place + normal * (side * height * state.tolerance);
    if (!meets_angles(state.mesh, worker.proposal, worker.limits, &gain)) continue;
    refusal = check_move(state, worker, normal, gain, FirstAsked::kRing);
  }
  return refusal;
}

// Places for a vertex on the edge (u, v): on it and towards the corners beside it, a little above and below,
// and further where nothing else has helped.
std::vector<Vec3> insertion_places(const CertifiedState& state, const Worker& worker, Index u, Index v,
                                   Vec3 normal) {
  constexpr std::array<double, 7> kHeightsOff{0, 0.3, -0.3, 0.7, -0.7, 1.2, -1.2};  // tolerances
  const std::size_t heights = worker.limits.growth > 0 ? kHeightsOff.size() : 3;
  const Proposal& proposal = worker.proposal;
  const Vec3 middle = (state.mesh.points[u] + state.mesh.points[v]) * 0.5;
  const Vec3 along = state.mesh.points[v] - middle;
  const Vec3 to_rim = rim_centroid(state.mesh, proposal) - middle;
  std::vector<Vec3> places;
  const auto add = [&](Vec3 place) {
    for (std::size_t i = 0; i < heights; ++i)
      places.push_back(place + normal * (kHeightsOff[i] * state.tolerance));
  };
  for (const double part : {0.0, 0.3, 0.6, 1.0}) add(middle + to_rim * part);
  for (const Index beside : proposal.rim) {
    if (beside == u || beside == v) continue;
    for (const double part : {0.15, 0.4}) {
      for (const double shift : {0.0, 0.4, -0.4}) {
        add(middle + along * shift + (state.mesh.points[beside] - middle) * part);
      }
    }
  }
  return places;
}

}  // namespace

Refusal check_move(CertifiedState& state, Worker& worker, Vec3 facing, double gain, FirstAsked asked) {
  const bool mends = gain > least_angle_gain(worker.limits);
  if (!meets_topology(state.mesh, worker.proposal, worker.limits, mends)) return Refusal::kTopology;
  return check(state, worker, facing, mends, asked);
}

void commit_move(CertifiedState& state, Worker& worker) {
  const Proposal& proposal = worker.proposal;
  apply(proposal, state.mesh);
  if (state.reverse_tolerance > 0) commit_reverse(proposal, worker.reverse, state.proofs);
  if (proposal.removed != kNoIndex) {
    state.quadrics[proposal.moved] += state.quadrics[proposal.removed];
  }
  state.sheets.insert(state.mesh, proposal, worker.sheets);
}

void commit_insertion(CertifiedState& state, Worker& worker, Index u, Index v) {
  const Proposal& proposal = worker.proposal;
  const Vec3 middle = (state.mesh.points[u] + state.mesh.points[v]) * 0.5;
  Quadric& quadric = state.quadrics[proposal.moved];
  quadric = {};
  quadric.add_plane(state.reference.normals[proposal.place_nearest],
                    proposal.place - state.reference.points[0], squared_norm(state.mesh.points[u] - middle));
  commit_move(state, worker);
  worker.dead_points.pop_back();
  worker.dead_triangles.resize(worker.dead_triangles.size() - 2);
  ++worker.counts.insertions;
}

bool refuse_move(CertifiedState& state, Worker& worker, Refusal refusal, Index vertex) {
  ++worker.counts.refused[static_cast<std::size_t>(refusal)];
  state.blocked_by[vertex] = static_cast<std::uint8_t>(refusal);
  return false;
}

double least_angle_gain(const GuardLimits& limits) {
  if (limits.growth > 0) return std::numeric_limits<double>::lowest();
  if (limits.floor_angle > 0) return kWorthwhileGain;
  return limits.worst_angle_first ? 1e-11 : 1e-4;  // radians, or their fourth power
}

Vec3 edge_normal(const CertifiedState& state, Index u, Index v) {
  return normalized(state.reference.normals[state.mesh.nearest[u]] +
                    state.reference.normals[state.mesh.nearest[v]]);
}

std::uint32_t removal_signature(const CertifiedMesh& mesh, const Proposal& proposal) {
  std::uint32_t sum = mesh.version[proposal.moved] + mesh.version[proposal.removed];
  for (const Index v : proposal.rim) sum += mesh.version[v];
  return sum;
}

std::size_t removal_slot(const CertifiedMesh& mesh, Index t, std::size_t k) {
  const LinkedTriangle& cell = mesh.triangles[t];
  const Index other = cell.across[k];
  if (other == kNoIndex || t < other) return 3 * std::size_t{t} + k;
  const LinkedTriangle& twin = mesh.triangles[other];
  return 3 * std::size_t{other} + 3 - twin.slot_of(cell.corner[(k + 1) % 3]) -
         twin.slot_of(cell.corner[(k + 2) % 3]);
}

MoveCounts& MoveCounts::operator+=(const MoveCounts& other) {
  removals += other.removals;
  insertions += other.insertions;
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
  if (state.mesh.is_on_contour(u) || state.mesh.is_on_contour(v)) return contour_removal_cost(state, u, v);
  Quadric quadric = state.quadrics[u];
  quadric += state.quadrics[v];
  const Vec3 origin = state.reference.points[0];
  const Vec3 pu = state.mesh.points[u] - origin, pv = state.mesh.points[v] - origin;
  const Vec3 place = best_place(quadric, (pu + pv) * 0.5, edge_normal(state, u, v), kStrengths[0]);
  return std::max(0.0, quadric.at(place)) + kLengthWeight * quadric.trace() * squared_norm(pu - pv);
}

bool try_removal(CertifiedState& state, Worker& worker, Index t, std::size_t k) {
  if (touches_contour(state.mesh, t, k)) return try_contour_removal(state, worker, t, k, false);
  const LinkedTriangle& cell = state.mesh.triangles[t];
  const Index u = cell.corner[(k + 1) % 3], v = cell.corner[(k + 2) % 3];
  Proposal& proposal = worker.proposal;
  if (!propose_removal(state.mesh, t, k, proposal)) return refuse_move(state, worker, Refusal::kLink, u);
  const std::uint32_t signature = removal_signature(state.mesh, proposal) + (worker.is_thorough ? 1 : 0);
  const std::size_t slot = removal_slot(state.mesh, t, k);
  if (state.failed[slot] == signature) return false;
  const Vec3 normal = edge_normal(state, u, v);
  double gain = 0;
  Refusal refusal = place_merged(state, worker, normal, gain);
  if (refusal == Refusal::kNone && makes_neck(state.mesh, proposal)) refusal = Refusal::kLink;
  if (refusal == Refusal::kNone) refusal = check_at_heights(state, worker, normal, gain);
  if (refusal != Refusal::kNone) {
    state.failed[slot] = signature;
    return refuse_move(state, worker, refusal, u);
  }
  commit_move(state, worker);
  ++worker.counts.removals;
  return true;
}

bool try_mending_removal(CertifiedState& state, Worker& worker, Index t, std::size_t k) {
  if (touches_contour(state.mesh, t, k)) return try_contour_removal(state, worker, t, k, true);
  Proposal& proposal = worker.proposal;
  if (!propose_removal(state.mesh, t, k, proposal) || makes_neck(state.mesh, proposal)) return false;
  const Vec3 a = state.mesh.points[proposal.moved], b = state.mesh.points[proposal.removed];
  const Vec3 normal = edge_normal(state, proposal.moved, proposal.removed);
  for (const Vec3& place : {(a + b) * 0.5, a, b, rim_centroid(state.mesh, proposal)}) {
    proposal.place = place;
    double gain = 0;
    if (!meets_angles(state.mesh, proposal, worker.limits, &gain) || gain < least_angle_gain(worker.limits))
      continue;
    if (check_move(state, worker, normal, gain, FirstAsked::kTriangles) != Refusal::kNone) continue;
    commit_move(state, worker);
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
  if (!propose_swap(state.mesh, t, k, proposal)) return refuse_move(state, worker, Refusal::kLink, u);
  double gain = 0;
  Refusal refusal =
      meets_angles(state.mesh, proposal, worker.limits, &gain) ? Refusal::kNone : Refusal::kAngle;
  if (improve_angles && gain < least_angle_gain(worker.limits)) return false;
  const bool mends = gain > least_angle_gain(worker.limits);
  if (refusal == Refusal::kNone && !meets_topology(state.mesh, proposal, worker.limits, mends)) {
    refusal = Refusal::kTopology;
  }
  if (refusal == Refusal::kNone) refusal = check(state, worker, {}, mends, first_asked(improve_angles));
  if (refusal != Refusal::kNone) return refuse_move(state, worker, refusal, u);
  commit_move(state, worker);
  ++worker.counts.swaps;
  return true;
}

bool try_insertion(CertifiedState& state, Worker& worker, Index t, std::size_t k) {
  if (worker.dead_points.empty() || worker.dead_triangles.size() < 2) return false;
  const Index vertex = worker.dead_points.back();
  const std::size_t count = worker.dead_triangles.size();
  const std::array<Index, 2> triangles{worker.dead_triangles[count - 1], worker.dead_triangles[count - 2]};
  Proposal& proposal = worker.proposal;
  if (!propose_insertion(state.mesh, t, k, vertex, triangles, proposal)) return false;
  const auto& corner = state.mesh.triangles[t].corner;
  const Index u = corner[(k + 1) % 3], v = corner[(k + 2) % 3];
  const Vec3 normal = edge_normal(state, u, v);
  state.mesh.valence[vertex] = 0;
  const bool counts = worker.limits.worst_angle_first && !(worker.limits.growth > 0);
  const double least = counts ? kLeastInsertionGain : least_angle_gain(worker.limits);
  std::vector<std::pair<double, Vec3>> places;  // with the fall of the sum of deficits, negative
  for (const Vec3 place : insertion_places(state, worker, u, v, normal)) {
    proposal.place = place;
    double gain = 0;
    if (meets_angles(state.mesh, proposal, worker.limits, &gain) && gain >= least)
      places.emplace_back(-gain, place);
  }
  std::stable_sort(places.begin(), places.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  for (const auto& [loss, place] : places) {
    proposal.place = place;
    if (check_move(state, worker, normal, -loss, FirstAsked::kTriangles) != Refusal::kNone) continue;
    commit_insertion(state, worker, u, v);
    return true;
  }
  return false;
}

bool try_relocation(CertifiedState& state, Worker& worker, Index vertex, Vec3 place, bool improve_angles) {
  if (state.mesh.is_on_contour(vertex)) {
    return try_contour_relocation(state, worker, vertex, place, improve_angles);
  }
  Proposal& proposal = worker.proposal;
  if (!propose_relocation(state.mesh, vertex, proposal)) return false;
  proposal.place = place;
  double gain = 0;
  if (!meets_angles(state.mesh, proposal, worker.limits, &gain)) return false;
  if (improve_angles && gain < least_angle_gain(worker.limits)) return false;
  const Vec3 facing = state.reference.normals[state.mesh.nearest[vertex]];
  const bool mends = gain > least_angle_gain(worker.limits);
  if (check(state, worker, facing, mends, first_asked(improve_angles)) != Refusal::kNone) return false;
  commit_move(state, worker);
  ++worker.counts.relocations;
  return true;
}

}  // namespace periost
