#include "stages/improve/thin_split.h"

#include <algorithm>
#include <tuple>
#include <vector>

namespace periost {
namespace {

constexpr double kLeastSine = 0.3420201433256687;  // 20 degrees
constexpr std::size_t kLongestRing = 40;

struct CrossEdge {
  double length;  // squared
  Index a, b;     // a < b
};

// Every edge between points on walls once, longest first; edges on walls are sorted out by their open rings.
std::vector<CrossEdge> cross_edges(const TetComplex& complex) {
  std::vector<CrossEdge> edges;
  for (Index t = 0; t < complex.corners.size(); ++t) {
    if (!complex.is_live(t)) continue;
    for (const auto& [i, j] : kTetEdge) {
      const auto [a, b] = std::minmax(complex.corners[t][static_cast<std::size_t>(i)],
                                      complex.corners[t][static_cast<std::size_t>(j)]);
      if (complex.is_on_wall[a] == 0 || complex.is_on_wall[b] == 0) continue;
      edges.push_back({squared_norm(complex.position[a] - complex.position[b]), a, b});
    }
  }
  const auto key = [](const CrossEdge& e) { return std::make_tuple(-e.length, e.a, e.b); };
  std::sort(edges.begin(), edges.end(), [&](const auto& x, const auto& y) { return key(x) < key(y); });
  edges.erase(std::unique(edges.begin(), edges.end(),
                          [](const auto& x, const auto& y) { return x.a == y.a && x.b == y.b; }),
              edges.end());
  return edges;
}

}  // namespace

std::size_t split_thin_walls(TetComplex& complex, std::size_t room) {
  std::vector<Index> star, ring, points;
  std::vector<Tetrahedron> fresh;
  std::size_t splits = 0;
  for (const CrossEdge& edge : cross_edges(complex)) {
    complex.star(edge.a, star);
    const auto with_edge =
        std::find_if(star.begin(), star.end(), [&](Index tet) { return complex.has_corner(tet, edge.b); });
    if (with_edge == star.end() || !complex.ring(*with_edge, edge.a, edge.b, kLongestRing, ring, points) ||
        ring.size() > room) {
      continue;
    }
    const Index middle = complex.add_point(0.5 * (complex.position[edge.a] + complex.position[edge.b]));
    fresh.clear();
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Index from = points[i], to = points[(i + 1) % points.size()];
      fresh.push_back({edge.a, middle, from, to});
      fresh.push_back({middle, edge.b, from, to});
    }
    const bool is_good = std::all_of(fresh.begin(), fresh.end(), [&](const Tetrahedron& tet) {
      return complex.measure(tet) >= kLeastSine;
    });
    if (!is_good || !complex.replace(ring, fresh)) {
      complex.drop_last_point();
      continue;
    }
    room -= ring.size();
    ++splits;
  }
  return splits;
}

}  // namespace periost
