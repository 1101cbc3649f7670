#include "stages/improve/boundary_slide.h"

#include <algorithm>
#include <cmath>

#include "stages/improve/slide_trial.h"

namespace periost {
namespace {

constexpr double kJustWithin = 1 - 1e-6;  // of the tolerance, so that rounding stays inside it

ImproveBox box_around(const std::vector<Vec3>& points, const Triangle& triangle) {
  ImproveBox box;
  for (const Index corner : triangle) box.take(points[corner]);
  return box;
}

}  // namespace

BoundarySlide::BoundarySlide(TetComplex& complex, const std::vector<Triangle>& boundary,
                             const SlideReference& reference, double tolerance_mm)
    : complex_(complex),
      boundary_(boundary),
      reference_(reference),
      tolerance_(tolerance_mm * kJustWithin),
      first_place_(complex.position),
      boundary_grid_(complex.position, boundary),
      failed_(complex.position.size(), 0) {
  const auto& p = complex.position;
  first_.assign(p.size() + 1, 0);
  for (const Triangle& triangle : boundary) {
    for (const Index corner : triangle) ++first_[corner + 1];
    first_normal_.push_back(
        normalized(cross(p[triangle[1]] - p[triangle[0]], p[triangle[2]] - p[triangle[0]])));
  }
  for (std::size_t i = 0; i + 1 < first_.size(); ++i) first_[i + 1] += first_[i];
  incident_.resize(first_.back());
  std::vector<Index> next(first_.begin(), first_.end() - 1);
  for (Index t = 0; t < boundary.size(); ++t) {
    for (const Index corner : boundary[t]) incident_[next[corner]++] = t;
  }
}

std::size_t BoundarySlide::moved_points() const {
  std::size_t count = 0;
  for (std::size_t i = 0; i < first_place_.size(); ++i) {
    count += complex_.is_on_wall[i] != 0 && complex_.position[i] != first_place_[i] ? 1 : 0;
  }
  return count;
}

void BoundarySlide::near(const ImproveBox& box, std::vector<Index>& triangles) const {
  ImproveBox wider = box;  // by the way that points have gone since the grid was made
  wider.widen(farthest_);
  boundary_grid_.find(wider, triangles);
  std::erase_if(triangles, [&](Index t) { return !box_around(complex_.position, boundary_[t]).meets(box); });
}

ImproveBox BoundarySlide::reach(Index tet) const {
  ImproveBox box;
  std::vector<Index> star;
  for (const Index point : complex_.corners[tet]) {
    if (triangles_at(point).empty()) continue;
    complex_.star(point, star);
    for (const Index other : star) {
      for (const Index corner : complex_.corners[other]) box.take(complex_.position[corner]);
    }
    for (const Index t : triangles_at(point)) {
      for (const Index corner : boundary_[t]) box.take(complex_.position[corner]);
    }
  }
  box.widen(2 * tolerance_ + kLongestSlide * tolerance_);
  return box;
}

void BoundarySlide::make(const SlideMove& move) {
  complex_.move(move.point, move.place, move.star);
  farthest_ = std::max(farthest_, distance(move.place, first_place_[move.point]));
}

}  // namespace periost
