#include "stages/improve/boundary_slide.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pipeline/geometry/predicates.h"
#include "stages/improve/tet_removal.h"

namespace periost {
namespace {

constexpr double kLeastSlideGain = 0.01;  // of the smallest sine: a check is dear
constexpr int kSlideHalvings = 2;
constexpr double kLongestSlide = 2;             // tolerances
constexpr double kLeastCosine = 0.9397;         // normals turn by 20 degrees at most
constexpr double kCosineOfLeastAngle = 0.9063;  // 25 degrees, of surface triangles, unless they were worse
constexpr double kJustWithin = 1 - 1e-6;        // of the tolerance, so that rounding stays inside it

// Cosine of the smallest angle of a triangle.
double largest_cosine(const std::array<Vec3, 3>& corners) {
  double squares[3];
  for (std::size_t k = 0; k < 3; ++k) squares[k] = squared_norm(corners[(k + 2) % 3] - corners[(k + 1) % 3]);
  std::sort(squares, squares + 3);
  return (squares[1] + squares[2] - squares[0]) / (2 * std::sqrt(squares[1] * squares[2]));
}

bool do_boxes_meet(const ImproveBox& a, const ImproveBox& b) {
  return a.low.x <= b.high.x && b.low.x <= a.high.x && a.low.y <= b.high.y && b.low.y <= a.high.y &&
         a.low.z <= b.high.z && b.low.z <= a.high.z;
}

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
      distance_(reference, tolerance_),
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

// Normals and angles of the triangles at the point.
bool BoundarySlide::keeps_shape(Index point, Vec3 place) const {
  for (const Index* t = begin_of(point); t != end_of(point); ++t) {
    std::array<Vec3, 3> now, then;
    for (std::size_t k = 0; k < 3; ++k) {
      now[k] = complex_.position[boundary_[*t][k]];
      then[k] = boundary_[*t][k] == point ? place : now[k];
    }
    const Vec3 normal = normalized(cross(then[1] - then[0], then[2] - then[0]));
    if (dot(normal, first_normal_[*t]) < kLeastCosine) return false;
    const double cosine = largest_cosine(then);
    if (cosine > kCosineOfLeastAngle && cosine > largest_cosine(now)) return false;
  }
  return true;
}

ImproveBox BoundarySlide::star_box(Index point) const {
  ImproveBox box;
  for (const Index* t = begin_of(point); t != end_of(point); ++t) {
    for (const Index corner : boundary_[*t]) box.take(complex_.position[corner]);
  }
  return box;
}

SlidePatch BoundarySlide::patch(Index triangle) const {
  const auto& [a, b, c] = boundary_[triangle];
  return {complex_.position[a], complex_.position[b], complex_.position[c]};
}

// The boundary near the point, widened by the way that points have gone since the grid was made.
void BoundarySlide::gather(Index point) {
  if (is_gathered_) return;
  is_gathered_ = true;
  ImproveBox box = star_box(point);
  box.widen(2 * tolerance_);
  ImproveBox wider = box;
  wider.widen(farthest_);
  boundary_grid_.find(wider, near_boundary_);
  std::erase_if(near_boundary_,
                [&](Index t) { return !do_boxes_meet(box_around(complex_.position, boundary_[t]), box); });
  rest_.clear();
  for (const Index t : near_boundary_) {
    if (!std::binary_search(begin_of(point), end_of(point), t)) rest_.push_back(patch(t));
  }
}

// No triangle at the point meets another one.
bool BoundarySlide::keeps_apart(Index point, Vec3 place) {
  gather(point);
  const Vec3 kept = std::exchange(complex_.position[point], place);
  bool is_apart = true;
  for (const Index* t = begin_of(point); is_apart && t != end_of(point); ++t) {
    const ImproveBox box = box_around(complex_.position, boundary_[*t]);
    is_apart = std::none_of(near_boundary_.begin(), near_boundary_.end(), [&](Index other) {
      return other != *t && do_boxes_meet(box, box_around(complex_.position, boundary_[other])) &&
             triangles_intersect(complex_.position, boundary_[*t], boundary_[other]);
    });
  }
  complex_.position[point] = kept;
  return is_apart;
}

bool BoundarySlide::keeps_distance(Index point, Vec3 place) {
  const Vec3 kept = std::exchange(complex_.position[point], place);
  std::vector<SlidePatch> moved;
  for (const Index* t = begin_of(point); t != end_of(point); ++t) moved.push_back(patch(*t));
  complex_.position[point] = kept;
  if (!distance_.is_near(moved, place)) return false;
  gather(point);
  return distance_.is_covered(moved, rest_);
}

bool BoundarySlide::move_towards(Index point, Vec3 goal, double sine) {
  const Vec3 from = complex_.position[point];
  const double floor = sine + kLeastSlideGain;
  double share = std::min(1.0, kLongestSlide * tolerance_ / std::max(distance(from, goal), 1e-300));
  for (int halving = 0; halving <= kSlideHalvings; ++halving, share *= 0.5) {
    const Vec3 place = from + share * (goal - from);
    // Cheap tests first; that triangles meet is the rarest.
    if (smallest_sine(fans_, place, floor) <= floor || !keeps_shape(point, place) ||
        !keeps_distance(point, place) || !keeps_apart(point, place)) {
      continue;
    }
    complex_.move(point, place, star_);
    farthest_ = std::max(farthest_, distance(place, first_place_[point]));
    return true;
  }
  return false;
}

bool BoundarySlide::slide(Index point, double target) {
  if (begin_of(point) == end_of(point)) return false;
  complex_.star(point, star_);
  double before = 2;
  std::size_t walls = 0;
  fans_.clear();
  for (const Index tet : star_) {
    before = std::min(before, complex_.quality[tet]);
    const int corner = complex_.corner_of(tet, point);
    fans_.push_back(complex_.fan(tet, corner));
    for (int side = 0; side < 4; ++side) {
      walls += side != corner && complex_.neighbours[tet][as_size(side)] == kNoIndex ? 1 : 0;
    }
  }
  // More walls than boundary: faces between regions; fewer: two sheets that touch in the point.
  if (before >= target || walls != static_cast<std::size_t>(end_of(point) - begin_of(point))) return false;
  std::uint64_t state = 1;
  for (const Index tet : star_) state += complex_.version[tet] * std::uint64_t{0x9E3779B97F4A7C15} + tet;
  if (failed_[point] == state) return false;
  is_gathered_ = false;
  std::vector<SlidePatch> at_point;
  for (const Index* t = begin_of(point); t != end_of(point); ++t) at_point.push_back(patch(*t));
  distance_.begin(complex_.position[point], std::move(at_point));
  const Vec3 from = complex_.position[point];
  double reached = before;
  if (move_towards(point, climb(fans_, from, target, reached), before)) return true;
  Vec3 normal;
  for (const Index* t = begin_of(point); t != end_of(point); ++t) normal += first_normal_[*t];
  reached = before;
  Vec3 along = climb(fans_, from, target, reached, normalized(normal));
  // Back to the distance from the reference that the point had.
  const double within = distance(from, along) + 2 * tolerance_;
  const std::optional<SlideReference::Hit> then = reference_.closest(from, within);
  const std::optional<SlideReference::Hit> now = reference_.closest(along, within);
  if (then && now) along += (now->point - along) - (then->point - from);
  if (move_towards(point, along, before)) return true;
  failed_[point] = state;
  return false;
}

}  // namespace periost
