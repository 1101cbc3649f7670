#include "stages/decimate/certified_rescue.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <utility>

#include "stages/decimate/certified_patch.h"

namespace periost {
namespace {

constexpr int kRings = 4;        // of triangles in a patch; those in the outer two stay as they are
constexpr int kSplitSweeps = 6;  // over all edges of a patch
constexpr int kThinningRounds = 6;
constexpr int kMendingSweeps = 12, kLastSweeps = 3;  // at most, while something moves
// Of the least angle: triangles under it are rescued by rescue_pass, on a small surface nearly all that fall
// short.
constexpr double kFarUnder = 0.75, kUnder = 0.975;
constexpr std::ptrdiff_t kSmallSurface = 20'000;  // triangles
// rescue_pass tries so many recipes at least, and one for so many triangles.
constexpr std::size_t kLeastRecipes = 16, kTrianglesPerRecipe = 800;
constexpr double kTangible = 0.01;  // radians: the least rise of the worst angle

// One way of going about it.
struct Recipe {
  double length;           // edges longer than this are split; in mean edges of the patch
  int evening;             // relocations of all vertices, with swaps between
  double aim;              // of mending: in least angles
  bool worst_angle_first;  // while mending to the aim
};
// The first ones split hardly anything, so they bring hardly more triangles; they mend what lacks little.
constexpr std::array<Recipe, 2> kGentleRecipes{{{2.0, 2, 7.0 / 6, true}, {1.2, 2, 7.0 / 6, true}}};
constexpr std::array<Recipe, 6> kRecipes{{{0.9, 2, 4.0 / 3, true},
                                          {0.65, 2, 4.0 / 3, false},
                                          {0.65, 2, 1.5, true},
                                          {0.65, 4, 1.5, false},
                                          {1.2, 4, 1.5, true},
                                          {0.65, 4, 7.0 / 6, true}}};

struct Quality {
  double worst;     // angle, radians
  double deficits;  // sum of their fourth powers

  bool is_better_than(const Quality& other) const {
    return worst > other.worst + kTangible && deficits < other.deficits;
  }
};

Quality quality_of(const CertifiedState& state, const Patch& patch, double limit) {
  Quality quality{limit, 0};
  for (const Index t : patch.triangles()) {
    const double angle = min_angle(corners_now(state.mesh, t));
    quality.worst = std::min(quality.worst, angle);
    quality.deficits += std::pow(std::max(0.0, limit - angle), 4);
  }
  return quality;
}

// The edge of triangle t opposite to corner k.
struct Edge {
  double length;  // mm
  Index t;
  std::size_t k;
};

double length_now(const CertifiedMesh& mesh, Index t, std::size_t k) {
  const auto c = corners_now(mesh, t);
  return distance(c[(k + 1) % 3], c[(k + 2) % 3]);
}

// The edges of a patch between free vertices, longest first.
std::vector<Edge> edges_of(const CertifiedMesh& mesh, const Patch& patch) {
  std::vector<Edge> edges;
  for (const Index t : patch.triangles()) {
    const LinkedTriangle& cell = mesh.triangles[t];
    for (std::size_t k = 0; k < 3; ++k) {
      const Index u = cell.corner[(k + 1) % 3], v = cell.corner[(k + 2) % 3];
      if (u > v || mesh.is_locked[u] || mesh.is_locked[v]) continue;
      edges.push_back({length_now(mesh, t, k), t, k});
    }
  }
  std::stable_sort(edges.begin(), edges.end(),
                   [](const Edge& a, const Edge& b) { return a.length > b.length; });
  return edges;
}

double mean_length(const std::vector<Edge>& edges) {
  double sum = 0;
  for (const Edge& edge : edges) sum += edge.length;
  return edges.empty() ? 0 : sum / static_cast<double>(edges.size());
}

// Under these, angles do not count.
GuardLimits without_angles(GuardLimits limits) {
  limits.min_angle = 1e-3;
  limits.growth = std::numeric_limits<double>::max();
  limits.worst_angle_first = false;
  return limits;
}

// Inserts a dual vertex at the middle of an edge.
bool split(CertifiedState& state, Worker& worker, const Edge& edge) {
  const std::size_t count = worker.dead_triangles.size();
  if (worker.dead_points.empty() || count < 2) return false;
  const Index vertex = worker.dead_points.back();
  Proposal& proposal = worker.proposal;
  if (!propose_insertion(state.mesh, edge.t, edge.k, vertex,
                         {worker.dead_triangles[count - 1], worker.dead_triangles[count - 2]}, proposal))
    return false;
  const Index u = proposal.rim[0], v = proposal.rim[2];
  proposal.place = (state.mesh.points[u] + state.mesh.points[v]) * 0.5;
  state.mesh.valence[vertex] = 0;
  if (check_move(state, worker, edge_normal(state, u, v), 0, FirstAsked::kTriangles) != Refusal::kNone)
    return false;
  commit_insertion(state, worker, u, v);
  return true;
}

// Splits edges longer than `longest`, mm, for as long as there are any that can be.
void refine(CertifiedState& state, Worker& worker, const Patch& patch, double longest) {
  for (int sweep = 0; sweep < kSplitSweeps; ++sweep) {
    bool has_split = false;
    for (const Edge& edge : edges_of(state.mesh, patch)) {
      if (edge.length <= longest) break;
      // Splits before it may have put another edge in its place.
      if (length_now(state.mesh, edge.t, edge.k) == edge.length) has_split |= split(state, worker, edge);
    }
    if (!has_split) break;
  }
}

// Lays the patch onto the isosurface, its vertices in the middle of their neighbours.
void even_out(CertifiedState& state, Worker& worker, const Patch& patch, int rounds) {
  for (int round = 0; round < rounds; ++round) {
    if (round > 0) swap_pass(state, worker, patch.free_vertices());
    relocation_pass(state, worker, patch.free_vertices());
  }
}

template <class Pass>
void sweep_while_moving(const Worker& worker, int most, Pass&& pass) {
  for (int sweep = 0; sweep < most; ++sweep) {
    const std::uint64_t before = worker.counts.moves();
    pass();
    if (worker.counts.moves() == before) break;
  }
}

// Removes what the angles let go, with relocations between that make room for more.
void thin_out(CertifiedState& state, Worker& worker, const Patch& patch) {
  for (int round = 0; round < kThinningRounds; ++round) {
    if (round > 0) relocation_pass(state, worker, patch.free_vertices());
    const std::uint64_t before = worker.counts.removals;
    removal_pass(state, worker, patch.free_vertices(), std::numeric_limits<double>::max());
    if (worker.counts.removals == before) break;
    swap_pass(state, worker, patch.free_vertices());
  }
}

void follow(const Recipe& recipe, double mean, CertifiedState& state, Worker& worker, const Patch& patch) {
  const GuardLimits limits = worker.limits;
  const GuardLimits mending = mending_slivers(limits);
  worker.limits = without_angles(mending);
  refine(state, worker, patch, recipe.length * mean);
  even_out(state, worker, patch, recipe.evening);
  worker.limits = mending;
  worker.limits.worst_angle_first = recipe.worst_angle_first;
  const double aim = recipe.aim * limits.min_angle;
  worker.limits.min_angle = aim;
  sweep_while_moving(worker, kMendingSweeps, [&] { angle_pass(state, worker, patch.free_vertices(), aim); });
  worker.limits = limits;
  sweep_while_moving(worker, kLastSweeps, [&] { sliver_pass(state, worker, patch.free_vertices()); });
  thin_out(state, worker, patch);
}

// Follows the recipe in the patch around a triangle. Whether the result was kept.
bool mend_around(CertifiedState& state, Worker& worker, Index t, const Recipe& recipe) {
  const auto corner = state.mesh.triangles[t].corner;
  const double least = worker.limits.min_angle;
  Patch patch(state, worker, {corner[0], corner[1], corner[2]}, kRings);
  const Quality before = quality_of(state, patch, least);
  follow(recipe, mean_length(edges_of(state.mesh, patch)), state, worker, patch);
  if (quality_of(state, patch, least).is_better_than(before)) return true;
  patch.restore();
  return false;
}

// Whether no lock is near: pieces leave what lies at their borders to one another.
bool is_free_around(const CertifiedMesh& mesh, const std::array<Index, 3>& corner) {
  Star star;
  return std::all_of(corner.begin(), corner.end(), [&](Index v) {
    return !mesh.is_locked[v] && gather_ring(mesh, v, star) && !is_any_locked(mesh, star.link);
  });
}

// Each recipe on all slivers that are left, the worst first. How many of the tries that there may be are
// left.
std::size_t rescue_by(std::span<const Recipe> recipes, CertifiedState& state, Worker& worker, double limit,
                      std::size_t tries, const Context& context) {
  for (const Recipe& recipe : recipes) {
    for (const Index t : find_slivers(state, limit)) {
      if (tries == 0) return 0;
      context.check_cancelled();
      const LinkedTriangle& cell = state.mesh.triangles[t];
      if (!cell.is_alive() || !has_angle_under(corners_now(state.mesh, t), limit)) continue;
      if (!is_free_around(state.mesh, cell.corner)) continue;
      mend_around(state, worker, t, recipe);
      --tries;
    }
  }
  return tries;
}

}  // namespace

std::vector<Index> find_slivers(const CertifiedState& state, double limit) {
  std::vector<std::pair<double, Index>> found;
  for (Index t = 0; t < state.mesh.triangles.size(); ++t) {
    if (!state.mesh.triangles[t].is_alive()) continue;
    const auto corners = corners_now(state.mesh, t);
    if (has_angle_under(corners, limit)) found.emplace_back(min_angle(corners), t);
  }
  std::sort(found.begin(), found.end());
  std::vector<Index> slivers;
  for (const auto& [angle, t] : found) slivers.push_back(t);
  return slivers;
}

void rescue_slivers(CertifiedState& state, Worker& worker, double limit, std::size_t recipes,
                    const Context& context) {
  rescue_by(kRecipes, state, worker, limit, recipes, context);
}

void rescue_pass(CertifiedState& state, Worker& worker, const Context& context) {
  const auto living = std::count_if(state.mesh.triangles.begin(), state.mesh.triangles.end(),
                                    [](const LinkedTriangle& t) { return t.is_alive(); });
  const std::size_t recipes = std::max(kLeastRecipes, static_cast<std::size_t>(living) / kTrianglesPerRecipe);
  // Those far under the limit first, whatever it takes: what little the others lack shall not use up the
  // recipes.
  for (const double part : {kFarUnder, kUnder}) {
    if (part == kUnder && living >= kSmallSurface) break;
    const double limit = part * worker.limits.min_angle;
    const std::size_t slivers = find_slivers(state, limit).size();
    if (slivers == 0) continue;
    const std::size_t left =
        part == kUnder ? rescue_by(kGentleRecipes, state, worker, limit, recipes, context) : recipes;
    rescue_by(kRecipes, state, worker, limit, left, context);
    context.debug("decimate.rescue", std::to_string(find_slivers(state, limit).size()) + " of " +
                                         std::to_string(slivers) + " slivers left after their rescue");
  }
}

}  // namespace periost
