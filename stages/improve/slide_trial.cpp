#include "stages/improve/slide_trial.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "pipeline/geometry/predicates.h"

namespace periost {
namespace {

constexpr int kSlideHalvings = 2;
constexpr double kLeastCosine = 0.9397;         // normals turn by 20 degrees at most
constexpr double kCosineOfLeastAngle = 0.9063;  // 25 degrees, of surface triangles, unless they were worse
constexpr std::array<double, 5> kSearchRadii{0.1, 0.25, 0.5, 1, 2};  // tolerances

// Cosine of the smallest angle of a triangle.
double largest_cosine(const SlidePatch& corners) {
  double squares[3];
  for (std::size_t k = 0; k < 3; ++k) squares[k] = squared_norm(corners[(k + 2) % 3] - corners[(k + 1) % 3]);
  std::sort(squares, squares + 3);
  return (squares[1] + squares[2] - squares[0]) / (2 * std::sqrt(squares[1] * squares[2]));
}

// Places on the surface of a cube, as unit vectors: 98 directions.
std::vector<Vec3> search_directions() {
  std::vector<Vec3> directions;
  for (int x = -2; x <= 2; ++x) {
    for (int y = -2; y <= 2; ++y) {
      for (int z = -2; z <= 2; ++z) {
        if (std::max({std::abs(x), std::abs(y), std::abs(z)}) == 2) {
          directions.push_back(
              normalized({static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)}));
        }
      }
    }
  }
  return directions;
}

}  // namespace

SlidePatch SlideTrial::patch(Index triangle, Vec3 place) const {
  SlidePatch corners;
  const Triangle& indices = slide_.triangle(triangle);
  for (std::size_t k = 0; k < 3; ++k) {
    corners[k] = indices[k] == move_.point ? place : slide_.complex().position[indices[k]];
  }
  return corners;
}

// Gathers the point's star; false where the point must stay or has nothing to gain.
bool SlideTrial::begin(Index point, double target, double& before) {
  const auto triangles = slide_.triangles_at(point);
  if (triangles.empty()) return false;
  const TetComplex& complex = slide_.complex();
  move_.point = point;
  complex.star(point, move_.star);
  before = 2;
  std::size_t walls = 0;
  fans_.clear();
  for (const Index tet : move_.star) {
    before = std::min(before, complex.quality[tet]);
    const int corner = complex.corner_of(tet, point);
    fans_.push_back(complex.fan(tet, corner));
    for (int side = 0; side < 4; ++side) {
      walls += side != corner && complex.neighbours[tet][as_size(side)] == kNoIndex ? 1 : 0;
    }
  }
  // More walls than boundary: faces between regions; fewer: two sheets that touch in the point.
  if (before >= target || walls != triangles.size()) return false;
  from_ = complex.position[point];
  is_gathered_ = false;
  moved_.clear();
  for (const Index t : triangles) moved_.push_back(patch(t, from_));
  distance_.begin(from_, moved_);
  return true;
}

// Normals and angles of the triangles at the point.
bool SlideTrial::keeps_shape(Vec3 place) const {
  for (const Index t : slide_.triangles_at(move_.point)) {
    const SlidePatch then = patch(t, place);
    const Vec3 normal = normalized(cross(then[1] - then[0], then[2] - then[0]));
    if (dot(normal, slide_.first_normal(t)) < kLeastCosine) return false;
    const double cosine = largest_cosine(then);
    if (cosine > kCosineOfLeastAngle && cosine > largest_cosine(patch(t, from_))) return false;
  }
  return true;
}

void SlideTrial::gather() {
  if (is_gathered_) return;
  is_gathered_ = true;
  const auto at_point = slide_.triangles_at(move_.point);
  ImproveBox box;
  for (const Index t : at_point) {
    for (const Vec3 corner : patch(t, from_)) box.take(corner);
  }
  box.widen(2 * slide_.tolerance());
  slide_.near(box, near_);
  std::erase_if(near_, [&](Index t) { return std::binary_search(at_point.begin(), at_point.end(), t); });
  rest_.clear();
  for (const Index t : near_) rest_.push_back(patch(t, from_));
  near_.insert(near_.begin(), at_point.begin(), at_point.end());

  std::vector<Index> corners;
  for (const Index t : near_) {
    corners.insert(corners.end(), slide_.triangle(t).begin(), slide_.triangle(t).end());
  }
  std::sort(corners.begin(), corners.end());
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  local_points_.clear();
  for (const Index corner : corners) local_points_.push_back(slide_.complex().position[corner]);
  local_.clear();
  for (const Index t : near_) {
    Triangle& numbered = local_.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      const auto place = std::lower_bound(corners.begin(), corners.end(), slide_.triangle(t)[k]);
      numbered[k] = static_cast<Index>(place - corners.begin());
    }
  }
}

// No triangle at the point meets another one.
bool SlideTrial::keeps_apart(Vec3 place) {
  gather();
  const std::size_t at_point = slide_.triangles_at(move_.point).size();
  for (std::size_t t = 0; t < at_point; ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (slide_.triangle(near_[t])[k] == move_.point) local_points_[local_[t][k]] = place;
    }
  }
  const auto box_of = [&](const Triangle& triangle) {
    ImproveBox box;
    for (const Index corner : triangle) box.take(local_points_[corner]);
    return box;
  };
  for (std::size_t t = 0; t < at_point; ++t) {
    const ImproveBox box = box_of(local_[t]);
    for (std::size_t other = 0; other < local_.size(); ++other) {
      if (other != t && box.meets(box_of(local_[other])) &&
          triangles_intersect(local_points_, local_[t], local_[other])) {
        return false;
      }
    }
  }
  return true;
}

bool SlideTrial::keeps_distance(Vec3 place) {
  moved_.clear();
  for (const Index t : slide_.triangles_at(move_.point)) moved_.push_back(patch(t, place));
  if (distance_.is_uncovered_again(moved_) || !distance_.is_near(moved_, place)) return false;
  gather();
  return distance_.is_covered(moved_, rest_);
}

// Cheap tests first; that triangles meet is the rarest.
bool SlideTrial::is_allowed(Vec3 place) {
  return keeps_shape(place) && keeps_distance(place) && keeps_apart(place);
}

bool SlideTrial::try_towards(Vec3 goal, double floor) {
  const double way = std::max(distance(from_, goal), 1e-300);
  double share = std::min(1.0, kLongestSlide * slide_.tolerance() / way);
  for (int halving = 0; halving <= kSlideHalvings; ++halving, share *= 0.5) {
    const Vec3 place = from_ + share * (goal - from_);
    if (smallest_sine(fans_, place, floor) <= floor || !is_allowed(place)) continue;
    move_.place = place;
    return true;
  }
  return false;
}

// Where the point climbs to in the surface, at the distance from the reference that it has.
Vec3 SlideTrial::along_surface(double target, double before) const {
  Vec3 normal;
  for (const Index t : slide_.triangles_at(move_.point)) normal += slide_.first_normal(t);
  double reached = before;
  Vec3 place = climb(fans_, from_, target, reached, normalized(normal));
  const double within = distance(from_, place) + 2 * slide_.tolerance();
  const std::optional<SlideReference::Hit> then = slide_.reference().closest(from_, within);
  const std::optional<SlideReference::Hit> now = slide_.reference().closest(place, within);
  if (then && now) place += (now->point - place) - (then->point - from_);
  return place;
}

bool SlideTrial::climb_to(Index point, double target, double gain) {
  double before = 2;
  if (!begin(point, target, before)) return false;
  auto state = static_cast<std::uint64_t>(1 + 1e6 * gain);
  for (const Index tet : move_.star) {
    state += slide_.complex().version[tet] * std::uint64_t{0x9E3779B97F4A7C15} + tet;
  }
  if (slide_.has_failed(point, state)) return false;
  // Along the surface first: free moves go outward more often than inward, and bodies would swell.
  if (try_towards(along_surface(target, before), before + gain)) return true;
  double reached = before;
  if (try_towards(climb(fans_, from_, target, reached), before + gain)) return true;
  slide_.note_failure(point, state);
  return false;
}

bool SlideTrial::search(Index point, double target, double gain) {
  static const std::vector<Vec3> kDirections = search_directions();
  double before = 2;
  if (!begin(point, target, before)) return false;
  const double floor = before + gain;
  std::vector<std::pair<double, Vec3>> places;  // by their smallest sine
  for (const double radius : kSearchRadii) {
    for (const Vec3 direction : kDirections) {
      const Vec3 place = from_ + (radius * slide_.tolerance()) * direction;
      const double sine = smallest_sine(fans_, place, floor);
      if (sine > floor) places.emplace_back(std::min(sine, target), place);
    }
  }
  std::stable_sort(places.begin(), places.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  const auto found =
      std::find_if(places.begin(), places.end(), [&](const auto& place) { return is_allowed(place.second); });
  if (found == places.end()) return false;
  move_.place = found->second;
  return true;
}

}  // namespace periost
