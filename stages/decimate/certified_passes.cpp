#include "stages/decimate/certified_passes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "pipeline/base/parallel.h"
#include "stages/decimate/certified_fetch.h"

namespace periost {
namespace {

constexpr std::size_t kQueueSize = 300;  // living vertices of one queue: what they read stays in the cache
constexpr double kRelocationStrength = 1.0;
constexpr double kLeastRelocation = 0.1;  // tolerances: smaller ones are not worth a check
constexpr int kSwapRounds = 4;            // around one removal
// D beyond which an edge near a removal is swapped: at once, or while later removals are likely to mend it.
constexpr int kMostDifference = 2, kMostDifferenceEarly = 6;
constexpr double kFit = 0.5;        // of the mean height: all of it would overshoot
constexpr double kLeastFit = 0.01;  // tolerances: smaller mean heights are left

constexpr double kSliverFoldCosine = 0.1;  // slivers have no normal to speak of, so mending them may turn it
constexpr double kSplitGrowth = 0.5;       // of the sum of deficits, that a split may cost for now
// Tell what was tried in a neighbourhood: by sliver_pass without insertions, and with them.
constexpr std::uint32_t kSliverMark = 0x51D0, kInsertionMark = 0x51D1;

struct Candidate {
  double cost;
  Index u, v;  // u < v
};

// Orders a heap with the cheapest on top; ties by number, so that the order is one and the same everywhere.
bool is_later(const Candidate& a, const Candidate& b) {
  if (a.cost != b.cost) return a.cost > b.cost;
  return a.u != b.u ? a.u > b.u : a.v > b.v;
}

bool is_alive(const CertifiedMesh& mesh, Index v) {
  return mesh.incident[v] != kNoIndex;
}

bool is_free(const CertifiedMesh& mesh, Index v) {
  return is_alive(mesh, v) && !mesh.is_locked[v];
}

// Calls visit(v, star) for each free vertex with a closed star.
template <class Visit>
void for_free_vertices(const CertifiedMesh& mesh, const VertexList& vertices, Visit&& visit) {
  Star star;
  for (const Index v : vertices) {
    if (is_free(mesh, v) && gather_star(mesh, v, star)) visit(v, star);
  }
}

// Likewise for each free vertex, those on contours too.
template <class Visit>
void for_free_rings(const CertifiedMesh& mesh, const VertexList& vertices, Visit&& visit) {
  Star ring;
  for (const Index v : vertices) {
    if (is_free(mesh, v) && gather_ring(mesh, v, ring)) visit(v, ring);
  }
}

// Changes when anything at a vertex or its link does, locks included.
std::uint32_t signature_of(const CertifiedMesh& mesh, Index v, const Star& star) {
  constexpr std::uint32_t kPerLock = 0x9E3779B9;
  std::uint32_t sum = mesh.version[v] + kPerLock * mesh.is_locked[v];
  for (const Index w : star.link) sum += mesh.version[w] + kPerLock * mesh.is_locked[w];
  return sum;
}

// Likewise for a triangle and the stars of its corners.
std::uint32_t signature_of(const CertifiedMesh& mesh, Index t) {
  std::uint32_t sum = 0;
  Star star;
  for (const Index v : mesh.triangles[t].corner) {
    if (gather_ring(mesh, v, star)) sum += signature_of(mesh, v, star);
  }
  return sum;
}

// The queue of one run of vertices.
class RemovalQueue {
 public:
  // Precondition: begin < end, ascending.
  RemovalQueue(const CertifiedState& state, const Index* begin, const Index* end, double limit)
      : state_(state), first_(*begin), last_(end[-1]), limit_(limit) {
    for (const Index* u = begin; u != end; ++u) {
      if (is_free(state.mesh, *u)) add_edges_of(*u, true);
    }
    std::make_heap(heap_.begin(), heap_.end(), is_later);
  }

  void push_edges_of(Index u) { add_edges_of(u, false); }

  // The cheapest edge that still is what it was when it was entered; false when none is left.
  bool pop(Candidate& candidate, Star& star, std::size_t& spoke) {
    while (!heap_.empty()) {
      std::pop_heap(heap_.begin(), heap_.end(), is_later);
      candidate = heap_.back();
      heap_.pop_back();
      if (!is_alive(state_.mesh, candidate.u) || !is_alive(state_.mesh, candidate.v)) continue;
      if (!gather_ring(state_.mesh, candidate.u, star)) continue;
      for (spoke = 0; spoke < star.link.size() && star.link[spoke] != candidate.v; ++spoke) {
      }
      if (spoke < star.link.size() && removal_cost(state_, candidate.u, candidate.v) == candidate.cost) {
        return true;
      }
    }
    return false;
  }

 private:
  void add_edges_of(Index u, bool only_smaller_end) {
    if (!gather_ring(state_.mesh, u, star_)) return;
    for (const Index v : star_.link) {
      const Index lower = std::min(u, v), upper = std::max(u, v);
      if ((only_smaller_end && v < u) || lower < first_ || lower > last_) continue;
      if (state_.mesh.is_locked[v]) continue;
      const double cost = removal_cost(state_, lower, upper);
      if (cost > limit_) continue;
      heap_.push_back({cost, lower, upper});
      if (!only_smaller_end) std::push_heap(heap_.begin(), heap_.end(), is_later);
    }
  }

  const CertifiedState& state_;
  Index first_, last_;
  double limit_;
  std::vector<Candidate> heap_;
  Star star_;
};

// The edge from a ring's centre to link[spoke], as the triangle and the corner opposite to it.
struct EdgeOfTriangle {
  Index triangle;
  std::size_t slot;
};
EdgeOfTriangle edge_at(const CertifiedMesh& mesh, const Star& ring, std::size_t spoke) {
  const bool is_last = spoke == ring.triangle.size();  // at a contour only
  const Index t = ring.triangle[is_last ? spoke - 1 : spoke];
  const Index opposite = ring.link[is_last ? spoke - 1 : (spoke + 1) % ring.link.size()];
  return {t, mesh.triangles[t].slot_of(opposite)};
}

// Swaps one edge with a greater D among those of the star's triangles.
bool swap_one(CertifiedState& state, Worker& worker, const Star& star, int most_difference) {
  for (const Index t : star.triangle) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (state.mesh.triangles[t].across[k] == kNoIndex ||
          topological_difference(state.mesh, t, k) <= most_difference) {
        continue;
      }
      if (try_swap(state, worker, t, k, false)) return true;
    }
  }
  return false;
}

void sort_unique(VertexList& vertices) {
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
}

Vec3 link_centroid(const CertifiedMesh& mesh, const Star& star) {
  Vec3 sum;
  for (const Index v : star.link) sum += mesh.points[v];
  return sum / static_cast<double>(star.link.size());
}

// Area-weighted normal of a star.
Vec3 star_normal(const CertifiedMesh& mesh, const Star& star, Index centre) {
  Vec3 sum;
  const std::size_t count = star.link.size();
  for (std::size_t i = 0; i < count; ++i) {
    sum += cross(mesh.points[star.link[i]] - mesh.points[centre],
                 mesh.points[star.link[(i + 1) % count]] - mesh.points[centre]);
  }
  return normalized(sum);
}

// Places worth trying for a vertex of a bad triangle: the surface's best ones, and steps towards the height
// that makes the angle.
void angle_places(const CertifiedState& state, Index vertex, const Star& star, std::vector<Vec3>& places) {
  const Vec3 origin = state.reference.points[0], here = state.mesh.points[vertex];
  const Vec3 middle = link_centroid(state.mesh, star);
  const Vec3 normal = star_normal(state.mesh, star, vertex);
  places.clear();
  for (const double strength : {0.3, 3.0}) {
    places.push_back(origin + best_place(state.quadrics[vertex], middle - origin, normal, strength));
  }
  const Vec3 along = middle - here - normal * dot(middle - here, normal);
  for (const double step : {0.25, 0.5, 1.0}) places.push_back(here + along * step);
  for (const Index v : star.link) places.push_back(here + (state.mesh.points[v] - here) * 0.2);
}

bool mend_triangle(CertifiedState& state, Worker& worker, Index t) {
  const auto corner = state.mesh.triangles[t].corner;
  for (std::size_t k = 0; k < 3; ++k) {
    if (try_swap(state, worker, t, k, true)) return true;
  }
  std::size_t shortest = 0;
  double length = std::numeric_limits<double>::max();
  for (std::size_t k = 0; k < 3; ++k) {
    const double l =
        squared_norm(state.mesh.points[corner[(k + 1) % 3]] - state.mesh.points[corner[(k + 2) % 3]]);
    if (l < length) {
      length = l;
      shortest = k;
    }
  }
  for (const std::size_t k : {shortest, (shortest + 1) % 3, (shortest + 2) % 3}) {
    if (worker.quota == 0) break;
    if (!try_removal(state, worker, t, k) && !try_mending_removal(state, worker, t, k)) continue;
    --worker.quota;
    return true;
  }
  Star star;
  std::vector<Vec3> places;
  for (const Index v : corner) {
    if (!gather_star(state.mesh, v, star)) continue;
    angle_places(state, v, star, places);
    for (const Vec3& place : places) {
      if (try_relocation(state, worker, v, place, true)) return true;
    }
  }
  return false;
}

// Places around a vertex in many directions along the surface and off it, near and far.
void surrounding_places(const CertifiedState& state, Index vertex, const Star& star,
                        std::vector<Vec3>& places) {
  const Vec3 here = state.mesh.points[vertex];
  const Vec3 normal = star_normal(state.mesh, star, vertex);
  const Vec3 towards = state.mesh.points[star.link[0]] - here;
  const Vec3 x = normalized(towards - normal * dot(towards, normal));
  const Vec3 y = cross(normal, x);
  double size = 0;
  for (const Index v : star.link) size += distance(state.mesh.points[v], here);
  size /= static_cast<double>(star.link.size());
  places.clear();
  constexpr int kDirections = 12;
  for (const double part : {0.0125, 0.05, 0.15, 0.4}) {
    for (int d = 0; d < kDirections; ++d) {
      const double angle = 6.283185307179586 * d / kDirections;
      const Vec3 along = (x * std::cos(angle) + y * std::sin(angle)) * (part * size);
      for (const double height : {0.0, 0.5, -0.5}) {
        places.push_back(here + along + normal * (height * part * size));
      }
    }
  }
}

// The place that helps most is tried first.
bool move_around(CertifiedState& state, Worker& worker, Index vertex) {
  Star star;
  std::vector<Vec3> places;
  Proposal& proposal = worker.proposal;
  if (!gather_star(state.mesh, vertex, star) || !propose_relocation(state.mesh, vertex, proposal))
    return false;
  surrounding_places(state, vertex, star, places);
  std::vector<std::pair<double, std::size_t>> gains;
  for (std::size_t i = 0; i < places.size(); ++i) {
    double gain = 0;
    proposal.place = places[i];
    if (meets_angles(state.mesh, proposal, worker.limits, &gain)) gains.emplace_back(-gain, i);
  }
  std::sort(gains.begin(), gains.end());
  return std::any_of(gains.begin(), gains.end(), [&](const auto& gain) {
    return try_relocation(state, worker, vertex, places[gain.second], true);
  });
}

bool insert_at(CertifiedState& state, Worker& worker, Index t) {
  for (std::size_t k = 0; k < 3; ++k) {
    if (try_insertion(state, worker, t, k)) return true;
  }
  return false;
}

// On the edges of all triangles at its corners.
bool insert_around(CertifiedState& state, Worker& worker, Index t) {
  Star star;
  for (const Index v : state.mesh.triangles[t].corner) {
    if (!gather_ring(state.mesh, v, star)) continue;
    for (const Index near : star.triangle) {
      if (insert_at(state, worker, near)) return true;
    }
  }
  return false;
}

bool mend_sliver(CertifiedState& state, Worker& worker, Index t) {
  if (mend_triangle(state, worker, t)) return true;
  const auto corner = state.mesh.triangles[t].corner;
  for (const Index v : corner) {
    if (move_around(state, worker, v)) return true;
  }
  if (insert_at(state, worker, t)) return true;
  Star star;
  for (const Index v : corner) {
    if (!gather_star(state.mesh, v, star)) continue;
    const std::vector<Index> link(star.link.begin(), star.link.end());
    for (const Index neighbour : link) {
      if (move_around(state, worker, neighbour)) return true;
    }
  }
  return insert_around(state, worker, t);
}

// Inserts on the longest edge that lets it.
bool split_longest(CertifiedState& state, Worker& worker, Index t) {
  const auto c = corners_now(state.mesh, t);
  const auto length = [&](std::size_t k) { return squared_norm(c[(k + 1) % 3] - c[(k + 2) % 3]); };
  std::array<std::size_t, 3> slots{0, 1, 2};
  std::stable_sort(slots.begin(), slots.end(),
                   [&](std::size_t a, std::size_t b) { return length(a) > length(b); });
  return std::any_of(slots.begin(), slots.end(),
                     [&](std::size_t k) { return try_insertion(state, worker, t, k); });
}

// Mean signed height of the isosurface over the triangles of a star, mm, weighed by its area seen along their
// normals: zero means that as much volume lies above the star as below.
double star_height(const CertifiedState& state, const Star& star) {
  double volume = 0, shadow = 0;
  for (const Index t : star.triangle) {
    const auto c = corners_now(state.mesh, t);
    const Vec3 n = normalized(cross(c[1] - c[0], c[2] - c[0]));
    state.proofs.for_homed(t, [&](Index s) {
      const auto p = state.reference.corners(s);
      const double area = dot(cross(p[1] - p[0], p[2] - p[0]), n);
      volume += area * dot((p[0] + p[1] + p[2]) / 3 - c[0], n);
      shadow += area;
    });
  }
  return shadow > 0 ? volume / shadow : 0;
}

// Along the surface where the quadric and the neighbours want a vertex; along the normal towards as much of
// the isosurface on one side as on the other.
Vec3 fair_place(const CertifiedState& state, Index v, const Star& star) {
  const Vec3 origin = state.reference.points[0], here = state.mesh.points[v];
  const Vec3 normal = star_normal(state.mesh, star, v);
  const Vec3 middle = link_centroid(state.mesh, star) - origin;
  const Vec3 place = origin + best_place(state.quadrics[v], middle, normal, kRelocationStrength);
  if (state.reverse_tolerance <= 0) return place;  // what lies over the star is not known
  return place + normal * (kFit * star_height(state, star) - dot(place - here, normal));
}

}  // namespace

double median_removal_cost(const CertifiedState& state, const Context& context) {
  constexpr Index kStride = 31;
  constexpr std::size_t kBlock = 256;
  std::vector<Index> sample;
  Index seen = 0;
  for (Index u = 0; u < state.mesh.points.size(); ++u) {
    if (is_free(state.mesh, u) && seen++ % kStride == 0) sample.push_back(u);
  }
  std::vector<std::vector<double>> costs_at(sample.size());
  parallel_blocks(context, sample.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    Star star;
    for (std::size_t i = begin; i < end; ++i) {
      const Index u = sample[i];
      if (!gather_star(state.mesh, u, star)) continue;
      for (const Index v : star.link) {
        costs_at[i].push_back(removal_cost(state, std::min(u, v), std::max(u, v)));
      }
    }
  });
  std::vector<double> costs;
  for (const auto& at : costs_at) costs.insert(costs.end(), at.begin(), at.end());
  if (costs.empty()) return 0;
  const auto middle = costs.begin() + static_cast<std::ptrdiff_t>(costs.size() / 2);
  std::nth_element(costs.begin(), middle, costs.end());
  return *middle;
}

void removal_pass(CertifiedState& state, Worker& worker, const VertexList& vertices, double limit) {
  const Index* const end = vertices.data() + vertices.size();
  Candidate candidate{};
  Star star;
  std::size_t spoke = 0;
  const int most_difference = worker.is_thorough ? kMostDifference : kMostDifferenceEarly;
  for (const Index* begin = vertices.data(); begin != end && worker.quota > 0;) {
    const Index* stop = begin;
    for (std::size_t living = 0; stop != end && living < kQueueSize; ++stop) {
      living += is_alive(state.mesh, *stop) ? 1 : 0;
    }
    fetch_ahead(state, worker, *begin, stop[-1]);
    RemovalQueue queue(state, begin, stop, limit);
    while (worker.quota > 0 && queue.pop(candidate, star, spoke)) {
      const EdgeOfTriangle edge = edge_at(state.mesh, star, spoke);
      if (!try_removal(state, worker, edge.triangle, edge.slot)) continue;
      --worker.quota;
      const Index merged = worker.proposal.moved;
      for (int round = 0; round < kSwapRounds && gather_ring(state.mesh, merged, star); ++round) {
        if (!swap_one(state, worker, star, most_difference)) break;
      }
      queue.push_edges_of(merged);
    }
    begin = stop;
  }
}

void swap_pass(CertifiedState& state, Worker& worker, const VertexList& vertices) {
  const int most_difference = worker.is_thorough ? kMostDifference : kMostDifferenceEarly;
  for_free_rings(state.mesh, vertices,
                 [&](Index, const Star& ring) { swap_one(state, worker, ring, most_difference); });
}

void relocation_pass(CertifiedState& state, Worker& worker, const VertexList& vertices) {
  const double least = kLeastRelocation * state.tolerance;
  for_free_vertices(state.mesh, vertices, [&](Index v, const Star& star) {
    const std::uint32_t signature = signature_of(state.mesh, v, star);
    if (state.settled[v] == signature) return;
    const Vec3 place = fair_place(state, v, star);
    if (squared_norm(place - state.mesh.points[v]) < least * least ||
        !try_relocation(state, worker, v, place, false)) {
      state.settled[v] = signature;
    }
  });
}

void fit_pass(CertifiedState& state, Worker& worker, const VertexList& vertices, double mean) {
  if (state.reverse_tolerance <= 0) return;
  for_free_vertices(state.mesh, vertices, [&](Index v, const Star& star) {
    const double step = mean + kFit * (star_height(state, star) - mean);
    // Moves outwards and inwards are not refused alike, so both together need not bring the volume back.
    if (std::abs(step) <= kLeastFit * state.tolerance || step * mean < 0) return;
    const Vec3 normal = star_normal(state.mesh, star, v);
    try_relocation(state, worker, v, state.mesh.points[v] + normal * step, false);
  });
}

void angle_pass(CertifiedState& state, Worker& worker, const VertexList& vertices, double aim) {
  const GuardLimits limits = std::exchange(worker.limits, aiming_at(worker.limits, aim));
  for_free_rings(state.mesh, vertices, [&](Index, const Star& star) {
    for (const Index t : star.triangle) {
      if (!has_angle_under(corners_now(state.mesh, t), aim)) continue;
      const std::uint32_t signature = signature_of(state.mesh, t);
      if (state.unmended[t] == signature) continue;
      if (mend_triangle(state, worker, t)) break;
      state.unmended[t] = signature;
    }
  });
  worker.limits = limits;
}

GuardLimits mending_slivers(GuardLimits limits) {
  limits.worst_angle_first = true;
  limits.fold_cosine = kSliverFoldCosine;
  limits.min_valence = 3;
  return limits;
}

VertexList sliver_vertices(const CertifiedState& state, double limit) {
  VertexList found;
  for (Index t = 0; t < state.mesh.triangles.size(); ++t) {
    if (!state.mesh.triangles[t].is_alive() || !has_angle_under(corners_now(state.mesh, t), limit)) continue;
    const auto& corner = state.mesh.triangles[t].corner;
    found.insert(found.end(), corner.begin(), corner.end());
  }
  sort_unique(found);
  return found;
}

VertexList sliver_vertices_near(const CertifiedState& state, double limit, const VertexList& vertices) {
  VertexList near, found;
  for_free_rings(state.mesh, vertices, [&](Index v, const Star& ring) {
    near.push_back(v);
    near.insert(near.end(), ring.link.begin(), ring.link.end());
  });
  sort_unique(near);
  for_free_rings(state.mesh, near, [&](Index, const Star& ring) {
    for (const Index t : ring.triangle) {
      if (!has_angle_under(corners_now(state.mesh, t), limit)) continue;
      const auto& corner = state.mesh.triangles[t].corner;
      found.insert(found.end(), corner.begin(), corner.end());
    }
  });
  sort_unique(found);
  return found;
}

void sliver_pass(CertifiedState& state, Worker& worker, const VertexList& vertices) {
  const GuardLimits limits = std::exchange(worker.limits, mending_slivers(worker.limits));
  const bool can_insert = !worker.dead_points.empty();
  for_free_rings(state.mesh, vertices, [&](Index, const Star& star) {
    for (const Index t : star.triangle) {
      if (!has_angle_under(corners_now(state.mesh, t), worker.limits.min_angle)) continue;
      const std::uint32_t signature = signature_of(state.mesh, t);
      const bool is_moved = state.unmended[t] == signature + kSliverMark;
      if ((is_moved && !can_insert) || state.unmended[t] == signature + kInsertionMark) continue;
      if (is_moved ? insert_around(state, worker, t) : mend_sliver(state, worker, t)) break;
      state.unmended[t] = signature + (can_insert ? kInsertionMark : kSliverMark);
    }
  });
  worker.limits = limits;
}

void split_pass(CertifiedState& state, Worker& worker, const VertexList& vertices, double limit) {
  const GuardLimits limits = std::exchange(worker.limits, mending_slivers(worker.limits));
  worker.limits.growth = kSplitGrowth;
  for_free_rings(state.mesh, vertices, [&](Index, const Star& star) {
    std::any_of(star.triangle.begin(), star.triangle.end(), [&](Index t) {
      return has_angle_under(corners_now(state.mesh, t), limit) && split_longest(state, worker, t);
    });
  });
  worker.limits = limits;
}

}  // namespace periost
