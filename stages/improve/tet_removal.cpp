#include "stages/improve/tet_removal.h"

#include <algorithm>

namespace periost {
namespace {

constexpr double kBest = 2;  // above every sine

}  // namespace

// The ring's triangle i < j < k stands for two tetrahedra, one with each end of the edge.
double TetRemoval::triangle_quality(Index a, Index b, std::size_t i, std::size_t j, std::size_t k,
                                    double floor) const {
  const auto& p = complex_.position;
  const Vec3 x = p[ring_[i]], y = p[ring_[j]], z = p[ring_[k]];
  const double above = smallest_sine(x, y, z, p[b]);
  if (above <= floor) return above;
  return std::min(above, smallest_sine(x, z, y, p[a]));
}

void TetRemoval::collect(Index a, Index b, std::size_t i, std::size_t j) {
  if (j - i < 2) return;
  const std::size_t k = apex_[i][j];
  fresh_.push_back({ring_[i], ring_[k], ring_[j], b});
  fresh_.push_back({ring_[i], ring_[j], ring_[k], a});
  collect(a, b, i, k);
  collect(a, b, k, j);
}

bool TetRemoval::remove_edge(Index tet, Index a, Index b, std::size_t room) {
  if (!complex_.ring(tet, a, b, kLongestRing, ring_tets_, ring_)) return false;
  const std::size_t n = ring_.size();
  if (n < 3 || n > 4 + room) return false;  // 2 n - 4 tetrahedra replace n
  double floor = kBest;
  for (const Index t : ring_tets_) floor = std::min(floor, complex_.quality[t]);
  floor += kLeastGain;

  std::array<std::array<double, kLongestRing>, kLongestRing> best;
  for (std::size_t i = 0; i + 1 < n; ++i) best[i][i + 1] = kBest;
  for (std::size_t span = 2; span < n; ++span) {
    for (std::size_t i = 0; i + span < n; ++i) {
      const std::size_t j = i + span;
      best[i][j] = -kBest;
      for (std::size_t k = i + 1; k < j; ++k) {
        const double sides = std::min(best[i][k], best[k][j]);
        if (sides <= floor || sides <= best[i][j]) continue;
        const double whole = std::min(sides, triangle_quality(a, b, i, k, j, std::max(floor, best[i][j])));
        if (whole <= best[i][j]) continue;
        best[i][j] = whole;
        apex_[i][j] = k;
      }
    }
  }
  if (best[0][n - 1] <= floor) return false;
  fresh_.clear();
  collect(a, b, 0, n - 1);
  return complex_.replace(ring_tets_, fresh_);
}

// Fills fresh_ and old_ beyond the edge u -> v of the faces between a and b, and returns the smallest sine of
// the new ones: one tetrahedron a, b, u, v closes the edge, or the face beyond is taken out, too. `below` and
// `above` hold u, v and a or b.
double TetRemoval::grow(Index a, Index b, Index u, Index v, Index below, Index above, double floor,
                        int depth) {
  const Tetrahedron closing{a, b, u, v};
  const double alone = complex_.measure(closing);
  if (alone > floor || depth == 0) {
    fresh_.push_back(closing);
    return alone;
  }
  const auto beyond = [&](Index tet, Index w) {
    return complex_.neighbours[tet][as_size(complex_.corner_of(tet, w))];
  };
  const auto other_corner = [&](Index tet, Index x, Index y, Index z) {
    for (const Index corner : complex_.corners[tet]) {
      if (corner != x && corner != y && corner != z) return corner;
    }
    return kNoIndex;
  };
  // The face so far is u, v and the fourth corner of below.
  const Index w = other_corner(below, a, u, v);
  const Index next_below = beyond(below, w), next_above = beyond(above, w);
  if (next_below != kNoIndex && next_above != kNoIndex) {
    const Index x = other_corner(next_below, a, u, v);
    const bool is_between = x != kNoIndex && x != b && complex_.has_corner(next_above, x) &&
                            complex_.side_towards(next_below, next_above) >= 0;
    if (is_between) {
      const std::size_t olds = old_.size(), news = fresh_.size();
      old_.push_back(next_below);
      old_.push_back(next_above);
      const double first = grow(a, b, u, x, next_below, next_above, floor, depth - 1);
      if (first > alone) {
        const double both = std::min(first, grow(a, b, x, v, next_below, next_above, floor, depth - 1));
        if (both > alone) return both;
      }
      old_.resize(olds);
      fresh_.resize(news);
    }
  }
  fresh_.push_back(closing);
  return alone;
}

bool TetRemoval::remove_faces(Index tet, int side, std::size_t room) {
  const Index other = complex_.neighbours[tet][as_size(side)];
  if (other == kNoIndex) return false;
  const Index a = complex_.corners[tet][as_size(side)];
  const Index b = complex_.corners[other][as_size(complex_.side_towards(other, tet))];
  const Triangle face = face_of(complex_.corners[tet], side);
  double floor = std::min(complex_.quality[tet], complex_.quality[other]) + kLeastGain;
  old_ = {tet, other};
  fresh_.clear();
  double reached = kBest;
  for (std::size_t i = 0; i < 3; ++i) {
    reached = std::min(reached, grow(a, b, face[i], face[(i + 1) % 3], tet, other, floor, kDeepest));
    if (reached <= floor) return false;
  }
  for (const Index t : old_) floor = std::min(floor, complex_.quality[t] + kLeastGain);
  if (reached <= floor || fresh_.size() > old_.size() + room) return false;
  return complex_.replace(old_, fresh_);
}

bool TetRemoval::remove_any(Index tet, std::size_t room) {
  const Tetrahedron c = complex_.corners[tet];
  for (const auto& [i, j] : kTetEdge) {
    if (remove_edge(tet, c[as_size(i)], c[as_size(j)], room)) return true;
  }
  for (int side = 0; side < 4; ++side) {
    if (remove_faces(tet, side, room)) return true;
  }
  return false;
}

}  // namespace periost
