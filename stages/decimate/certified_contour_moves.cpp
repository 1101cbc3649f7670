#include "stages/decimate/certified_contour_moves.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace periost {
namespace {

constexpr double kStrength = 0.05;  // of the regularisation along the contour
constexpr double kLengthCost = 1e-3;
constexpr int kMostChecks = 3;  // places of one removal that all criteria are tried on
// Places of a merged vertex, as parts of the way between the ends' stations.
constexpr std::array<double, 7> kParts{0.5, 0.3, 0.7, 0.1, 0.9, 0.0, 1.0};
constexpr double kLeastMove = 0.05;  // of the contour edges' length
constexpr std::uint32_t kContourMark = 0xC0;

struct Place {
  Vec3 at;
  double station;
};

bool is_locked(const CertifiedMesh& mesh, Index centre, const Star& ring) {
  return mesh.is_locked[centre] || is_any_locked(mesh, ring.link);
}

// Appends triangles first .. last - 1 of a ring to an open fan and its rim; the first rim vertex only where
// the rim is empty.
void append_to_fan(const Star& ring, std::size_t first, std::size_t last, Index apex, Proposal& proposal,
                   FixedList<Index, kMaxRing>& old_apex) {
  for (std::size_t i = first; i < last; ++i) {
    if (proposal.rim.size() == 0) proposal.rim.push_back(ring.link[i]);
    proposal.rim.push_back(ring.link[(i + 1) % ring.link.size()]);
    proposal.after.push_back(ring.triangle[i]);
    old_apex.push_back(apex);
  }
}

// The records of the open fan around `apex`.
void fill_cells(const CertifiedMesh& mesh, Index apex, const FixedList<Index, kMaxRing>& old_apex,
                Proposal& proposal) {
  const std::size_t count = proposal.after.size();
  for (std::size_t i = 0; i < count; ++i) {
    const LinkedTriangle& old = mesh.triangles[proposal.after[i]];
    proposal.cells.push_back(
        {{apex, proposal.rim[i], proposal.rim[i + 1]},
         {old.across[old.slot_of(old_apex[i])], i + 1 < count ? proposal.after[i + 1] : kNoIndex,
          i > 0 ? proposal.after[i - 1] : kNoIndex}});
  }
}

// How many triangles a vertex may lose and still have some.
int spare_triangles(const CertifiedMesh& mesh, Index v) {
  return mesh.valence[v] - (mesh.is_on_contour(v) ? 4 : 3);
}

bool propose_along(const CertifiedMesh& mesh, Index t, Index u, Index v, Index a, Proposal& proposal) {
  if (mesh.contour[u] == kPinned && mesh.contour[v] == kPinned) return false;
  Star ring_u, ring_v;  // u's begins with t, v's ends with it
  if (!gather_ring(mesh, u, ring_u) || !gather_ring(mesh, v, ring_v)) return false;
  if (is_locked(mesh, u, ring_u) || is_locked(mesh, v, ring_v)) return false;
  for (const Index x : ring_u.link) {
    if (x != a && ring_v.link.contains(x)) return false;
  }
  const std::size_t nu = ring_u.triangle.size(), nv = ring_v.triangle.size();
  if (nu + nv < 3 || spare_triangles(mesh, a) < 1) return false;
  for (const Index x : ring_u.triangle) proposal.before.push_back(x);
  for (const Index x : ring_v.triangle) {
    if (x != t) proposal.before.push_back(x);
  }
  proposal.moved = mesh.contour[v] == kPinned ? v : u;
  proposal.removed = proposal.moved == u ? v : u;
  FixedList<Index, kMaxRing> old_apex;
  append_to_fan(ring_v, 0, nv - 1, v, proposal, old_apex);
  append_to_fan(ring_u, 1, nu, u, proposal, old_apex);
  fill_cells(mesh, proposal.moved, old_apex, proposal);
  const int valence = static_cast<int>(nu + nv) + 1;
  proposal.valence_changes.push_back({proposal.moved, valence - mesh.valence[proposal.moved]});
  proposal.valence_changes.push_back({a, -1});
  return true;
}

// The inner vertex is contracted to the one on the contour. Triangle t = (a, u, v) lies on the left of the
// edge from the inner vertex u to v.
bool propose_onto(const CertifiedMesh& mesh, Index t, Index u, Index v, Proposal& proposal) {
  Star star, ring;
  if (!gather_star(mesh, u, star) || !gather_ring(mesh, v, ring)) return false;
  if (is_locked(mesh, u, star) || is_locked(mesh, v, ring)) return false;
  const std::size_t nu = star.triangle.size(), nv = ring.triangle.size();
  std::size_t start = 0, j = 0;
  while (star.triangle[start] != t) ++start;
  while (ring.triangle[j] != t) ++j;
  const Index a = ring.link[j], b = ring.link[j + 2];
  for (const Index x : star.link) {
    if (x != a && x != b && ring.link.contains(x)) return false;
  }
  if (a == b || spare_triangles(mesh, a) < 1 || spare_triangles(mesh, b) < 1) return false;
  for (const Index x : ring.triangle) proposal.before.push_back(x);
  FixedList<Index, kMaxRing> old_apex;
  append_to_fan(ring, 0, j, v, proposal, old_apex);
  for (std::size_t i = 1; i + 1 < nu; ++i) {
    const std::size_t at = (start + i) % nu;
    proposal.before.push_back(star.triangle[at]);
    append_to_fan(star, at, at + 1, u, proposal, old_apex);
  }
  append_to_fan(ring, j + 2, nv, v, proposal, old_apex);
  proposal.moved = v;
  proposal.removed = u;
  proposal.place = mesh.points[v];
  fill_cells(mesh, v, old_apex, proposal);
  proposal.valence_changes.push_back({v, static_cast<int>(nu) - 4});
  proposal.valence_changes.push_back({a, -1});
  proposal.valence_changes.push_back({b, -1});
  return true;
}

// The way from u to v along the contour and the stations around them.
struct Arc {
  Index loop;
  double before, from, to, after;
};

double between(const CertifiedState& state, const Arc& arc, double part) {
  const double at = arc.from + part * contour_way(state.contours, arc.loop, arc.from, arc.to);
  const double size = static_cast<double>(state.contours.loops[arc.loop].size());
  return at < size ? at : at - size;
}

bool is_strictly_between(const CertifiedState& state, const Arc& arc, double at) {
  const double way = contour_way(state.contours, arc.loop, arc.before, at);
  return way > 0 && way < contour_way(state.contours, arc.loop, arc.before, arc.after);
}

// Where the vertex merged from the contour edge u v may go, the best place first.
void merged_places(const CertifiedState& state, const Proposal& proposal, Index u, Index v, const Arc& arc,
                   std::vector<Place>& places) {
  const CertifiedContours& contours = state.contours;
  const ContourStation& station = contours.of(proposal.moved);
  places.clear();
  if (state.mesh.contour[proposal.moved] == kPinned) {
    places.push_back({state.mesh.points[proposal.moved], station.at});
    return;
  }
  Quadric quadric = state.quadrics[u];
  quadric += state.quadrics[v];
  const Vec3 origin = state.reference.points[0];
  const Vec3 along =
      state.mesh.points[contour_next(state.mesh, v)] - state.mesh.points[contour_previous(state.mesh, u)];
  const Vec3 aside = across_contour(state.reference.frame(), station.planes, along, edge_normal(state, u, v));
  for (const double part : kParts) {
    const double at = between(state, arc, part);
    const Vec3 on_contour = contour_point(contours, arc.loop, at);
    if (part == 0.5) {
      const Vec3 best = onto_planes(state.reference.frame(), station.planes,
                                    origin + best_place(quadric, on_contour - origin, aside, kStrength));
      places.push_back({best, nearest_station(contours, arc.loop, arc.before, arc.after, best)});
    }
    places.push_back({onto_planes(state.reference.frame(), station.planes, on_contour), at});
  }
}

// The contour certificate of the two edges at a moved vertex.
bool is_contour_certified(const CertifiedState& state, Index before, Index after, const Arc& arc,
                          const Place& place) {
  const Vec3 p = state.mesh.points[before], q = state.mesh.points[after];
  return is_strictly_between(state, arc, place.station) &&
         follows_contour(state.contours, arc.loop, arc.before, place.station, p, place.at, state.tolerance) &&
         follows_contour(state.contours, arc.loop, place.station, arc.after, place.at, q, state.tolerance);
}

// Angles, topology and all else at the proposal's place.
Refusal check_place(CertifiedState& state, Worker& worker, Vec3 facing, bool improve_angles) {
  double gain = 0;
  if (!meets_angles(state.mesh, worker.proposal, worker.limits, &gain)) return Refusal::kAngle;
  if (improve_angles && gain < least_angle_gain(worker.limits)) return Refusal::kAngle;
  return check_move(state, worker, facing, gain, FirstAsked::kRing);
}

// A removal of the contour edge from u to v.
Refusal remove_along(CertifiedState& state, Worker& worker, Index u, Index v, bool improve_angles) {
  const CertifiedContours& contours = state.contours;
  const Index before = contour_previous(state.mesh, u), after = contour_next(state.mesh, v);
  const Arc arc{contours.of(u).loop, contours.of(before).at, contours.of(u).at, contours.of(v).at,
                contours.of(after).at};
  std::vector<Place> places;
  merged_places(state, worker.proposal, u, v, arc, places);
  const Vec3 facing = edge_normal(state, u, v);
  Refusal refusal = Refusal::kDistance;
  int checks = 0;
  for (const Place& place : places) {
    worker.proposal.place = place.at;
    if (!is_contour_certified(state, before, after, arc, place)) continue;
    const Refusal found = check_place(state, worker, facing, improve_angles);
    if (found == Refusal::kNone) {
      state.contours.of(worker.proposal.moved).at = place.station;
      commit_move(state, worker);
      return found;
    }
    refusal = found;
    if (found != Refusal::kAngle && ++checks == kMostChecks) break;
  }
  return refusal;
}

bool has_small_angle(const CertifiedState& state, const Star& ring, double aim) {
  return std::any_of(ring.triangle.begin(), ring.triangle.end(),
                     [&](Index t) { return has_angle_under(corners_now(state.mesh, t), aim); });
}

}  // namespace

bool propose_contour_removal(const CertifiedMesh& mesh, Index t, std::size_t k, Proposal& proposal) {
  proposal.begin(MoveKind::kRemoval);
  const LinkedTriangle& cell = mesh.triangles[t];
  const Index u = cell.corner[(k + 1) % 3], v = cell.corner[(k + 2) % 3];
  const Index other = cell.across[k];
  if (other == kNoIndex) return propose_along(mesh, t, u, v, cell.corner[k], proposal);
  if (mesh.is_on_contour(u) && mesh.is_on_contour(v)) return false;
  return mesh.is_on_contour(v) ? propose_onto(mesh, t, u, v, proposal)
                               : propose_onto(mesh, other, v, u, proposal);
}

bool propose_contour_relocation(const CertifiedMesh& mesh, Index vertex, Proposal& proposal) {
  proposal.begin(MoveKind::kRelocation);
  Star ring;
  if (mesh.contour[vertex] == kPinned || !gather_ring(mesh, vertex, ring) || is_locked(mesh, vertex, ring))
    return false;
  for (const Index t : ring.triangle) {
    proposal.before.push_back(t);
    proposal.after.push_back(t);
    proposal.cells.push_back(mesh.triangles[t]);
  }
  for (const Index v : ring.link) proposal.rim.push_back(v);
  proposal.moved = vertex;
  return true;
}

double contour_removal_cost(const CertifiedState& state, Index u, Index v) {
  const CertifiedMesh& mesh = state.mesh;
  constexpr double kNever = std::numeric_limits<double>::max();
  const bool has_u = mesh.is_on_contour(u), has_v = mesh.is_on_contour(v);
  const auto is_fixed = [&](Index w) { return mesh.contour[w] == kPinned || mesh.is_locked[w]; };
  Quadric quadric = state.quadrics[u];
  quadric += state.quadrics[v];
  const Vec3 origin = state.reference.points[0];
  const Vec3 pu = mesh.points[u] - origin, pv = mesh.points[v] - origin;
  Vec3 place = has_u ? pu : pv;
  if (has_u && has_v) {
    const bool is_forward = contour_next(mesh, u) == v;
    if ((!is_forward && contour_next(mesh, v) != u) || (is_fixed(u) && is_fixed(v))) return kNever;
    place = is_fixed(u) ? pu : pv;
    if (!is_fixed(u) && !is_fixed(v)) {
      const Vec3 along = is_forward ? pv - pu : pu - pv;
      const Vec3 aside = across_contour(state.reference.frame(), state.contours.of(u).planes, along,
                                        edge_normal(state, u, v));
      place = best_place(quadric, (pu + pv) * 0.5, aside, kStrength);
    }
  }
  return std::max(0.0, quadric.at(place)) + kLengthCost * quadric.trace() * squared_norm(pu - pv);
}

bool try_contour_removal(CertifiedState& state, Worker& worker, Index t, std::size_t k, bool improve_angles) {
  const LinkedTriangle cell = state.mesh.triangles[t];
  const Index u = cell.corner[(k + 1) % 3], v = cell.corner[(k + 2) % 3];
  Proposal& proposal = worker.proposal;
  if (!propose_contour_removal(state.mesh, t, k, proposal)) {
    return improve_angles ? false : refuse_move(state, worker, Refusal::kLink, u);
  }
  const std::uint32_t signature = removal_signature(state.mesh, proposal) + kContourMark;
  const bool is_along = cell.across[k] == kNoIndex;
  const std::size_t slot = removal_slot(state.mesh, t, k);
  if (!improve_angles && state.failed[slot] == signature) return false;
  Refusal refusal = Refusal::kNone;
  if (is_along) {
    refusal = remove_along(state, worker, u, v, improve_angles);
  } else {
    refusal = check_place(state, worker, edge_normal(state, u, v), improve_angles);
    if (refusal == Refusal::kNone) commit_move(state, worker);
  }
  if (refusal == Refusal::kNone) {
    ++worker.counts.removals;
    return true;
  }
  if (improve_angles) return false;
  state.failed[slot] = signature;
  return refuse_move(state, worker, refusal, u);
}

bool try_contour_relocation(CertifiedState& state, Worker& worker, Index vertex, Vec3 place,
                            bool improve_angles) {
  if (!propose_contour_relocation(state.mesh, vertex, worker.proposal)) return false;
  const CertifiedContours& contours = state.contours;
  const Index before = contour_previous(state.mesh, vertex), after = contour_next(state.mesh, vertex);
  const ContourStation& station = contours.of(vertex);
  const Arc arc{station.loop, contours.of(before).at, station.at, station.at, contours.of(after).at};
  Place moved{onto_planes(state.reference.frame(), station.planes, place), 0};
  moved.station = nearest_station(contours, arc.loop, arc.before, arc.after, moved.at);
  if (!is_contour_certified(state, before, after, arc, moved)) return false;
  worker.proposal.place = moved.at;
  const Vec3 facing = state.reference.normals[state.mesh.nearest[vertex]];
  if (check_place(state, worker, facing, improve_angles) != Refusal::kNone) return false;
  state.contours.of(vertex).at = moved.station;
  commit_move(state, worker);
  ++worker.counts.relocations;
  return true;
}

void contour_pass(CertifiedState& state, Worker& worker, const std::vector<Index>& vertices, double aim) {
  if (state.mesh.contour.empty()) return;
  const GuardLimits limits = std::exchange(worker.limits, aiming_at(worker.limits, aim));
  Star ring;
  for (const Index v : vertices) {
    if (state.mesh.incident[v] == kNoIndex || state.mesh.is_locked[v] || !state.mesh.is_on_contour(v) ||
        state.mesh.contour[v] == kPinned || !gather_ring(state.mesh, v, ring)) {
      continue;
    }
    std::uint32_t signature = state.mesh.version[v] + kContourMark;
    for (const Index w : ring.link)
      signature += state.mesh.version[w] + 0x9E3779B9u * state.mesh.is_locked[w];
    if (state.settled[v] == signature) continue;
    const CertifiedContours& contours = state.contours;
    const double before = contours.of(ring.link[ring.link.size() - 1]).at,
                 after = contours.of(ring.link[0]).at;
    const Index loop = contours.of(v).loop;
    const double way = contour_way(contours, loop, before, after);
    const double size = static_cast<double>(contours.loops[loop].size());
    const bool improves = has_small_angle(state, ring, aim);
    bool has_moved = false;
    for (const double part : {0.5, 0.4, 0.6, 0.3, 0.7}) {
      const double at = std::fmod(before + part * way, size);
      const Vec3 place = contour_point(contours, loop, at);
      if (distance(place, state.mesh.points[v]) <
          kLeastMove * distance(state.mesh.points[v], state.mesh.points[ring.link[0]])) {
        continue;
      }
      has_moved = try_contour_relocation(state, worker, v, place, improves);
      if (has_moved || !improves) break;
    }
    if (!has_moved) state.settled[v] = signature;
  }
  worker.limits = limits;
}

}  // namespace periost
