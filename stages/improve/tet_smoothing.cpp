#include "stages/improve/tet_smoothing.h"

#include <algorithm>

#include "stages/improve/tet_removal.h"

namespace periost {

bool TetSmoothing::smooth(Index point, double target) {
  if (complex_.is_on_wall[point] != 0) return false;
  complex_.star(point, star_);
  double before = 2;
  for (const Index tet : star_) before = std::min(before, complex_.quality[tet]);
  if (before >= target) return false;
  fans_.clear();
  Vec3 sum;
  for (const Index tet : star_) {
    fans_.push_back(complex_.fan(tet, complex_.corner_of(tet, point)));
    sum += fans_.back().a + fans_.back().b + fans_.back().c;
  }
  double reached = before;
  Vec3 place = climb(fans_, complex_.position[point], target, reached);
  if (reached < target) {
    // Every point of the link is counted as often as it has triangles.
    const Vec3 centre = sum / (3.0 * static_cast<double>(fans_.size()));
    double other = smallest_sine(fans_, centre, reached);
    if (other > reached) {
      place = climb(fans_, centre, target, other);
      reached = other;
    }
  }
  if (reached <= before + kLeastGain) return false;
  complex_.move(point, place, star_);
  return true;
}

}  // namespace periost
