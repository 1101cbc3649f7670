#include "stages/improve/tet_improver.h"

#include <algorithm>
#include <cmath>

#include "pipeline/base/parallel.h"
#include "pipeline/base/quantity.h"

namespace periost {
namespace {

constexpr std::uint64_t kTriesPerTet = 30;  // then a round ends, whatever is left
constexpr std::uint64_t kPollEvery = 256;
constexpr std::size_t kGroup = 32;  // trials side by side
constexpr int kRescues = 8;         // times over all that is left
constexpr double kRescueGain = 0.003;
constexpr double kRescueTarget = 0.6428;    // 40 degrees
constexpr std::size_t kFewestRescued = 50;  // and a thousandth of all
constexpr std::size_t kTetsPerRescue = 1000;

}  // namespace

TetImprover::TetImprover(TetComplex& complex, BoundarySlide* slide, double max_growth, const Context& context)
    : complex_(complex),
      removal_(complex),
      smoothing_(complex),
      slide_(slide),
      context_(context),
      most_(static_cast<std::size_t>(static_cast<double>(complex.live) * (1 + max_growth))) {
  while (cavities_.size() < kGroup) cavities_.emplace_back(complex);
  while (slide != nullptr && trials_.size() < kGroup) trials_.emplace_back(*slide);
}

void TetImprover::queue(Index tet) {
  if (complex_.is_live(tet) && complex_.quality[tet] < round_.target) {
    queue_.push({complex_.quality[tet], tet, complex_.version[tet]});
  }
}

void TetImprover::queue_all(const std::vector<Index>& tets) {
  for (const Index tet : tets) queue(tet);
}

void TetImprover::round(const ImproveRound& round) {
  round_ = round;
  for (Index t = 0; t < complex_.corners.size(); ++t) queue(t);
  drain();
}

void TetImprover::drain() {
  const std::uint64_t most_tries = kTriesPerTet * (queue_.size() + 1000);
  const bool is_sliding = round_.is_sliding && slide_ != nullptr;
  group_.clear();
  insert_group_.clear();
  for (std::uint64_t tries = 0; tries < most_tries; ++tries) {
    if (tries % kPollEvery == 0) context_.check_cancelled();
    if (insert_group_.size() == kGroup || (queue_.empty() && !insert_group_.empty())) {
      insert_group();
      continue;
    }
    if (queue_.empty() || group_.size() >= kGroup) {
      if (group_.empty()) break;
      slide_group();
      continue;
    }
    const Bad bad = queue_.top();
    queue_.pop();
    if (!is_current(bad) || attack(bad.tet)) continue;
    if (round_.is_inserting) {
      insert_group_.push_back(bad);
    } else if (is_sliding) {
      group_.push_back(bad);
    }
  }
  queue_ = {};
}

bool TetImprover::smooth(Index point) {
  if (!smoothing_.smooth(point, round_.target)) return false;
  queue_all(smoothing_.star());
  return true;
}

// Means that need no other point; false where none of them changes the tetrahedron.
bool TetImprover::attack(Index tet) {
  if (removal_.remove_any(tet, room())) {
    queue_all(complex_.placed);
    return true;
  }
  const Tetrahedron corners = complex_.corners[tet];
  const std::uint32_t version = complex_.version[tet];
  for (const Index point : corners) {
    if (smooth(point) && complex_.quality[tet] >= round_.target) return true;
  }
  return complex_.version[tet] != version;
}

// Searches for all of the group side by side; makes what was found, worst first, unless one made before has
// changed what it is made of. Where nothing was found, boundary points may help.
void TetImprover::insert_group() {
  std::erase_if(insert_group_, [&](const Bad& bad) { return !is_current(bad); });
  const std::size_t count = insert_group_.size(), most = room();
  std::vector<std::uint8_t> is_found(count, 0);
  parallel_for(context_, count, [&](std::size_t i) {
    is_found[i] = cavities_[i].find(insert_group_[i].tet, round_.target, most, round_.price) ? 1 : 0;
  });
  for (std::size_t i = 0; i < count; ++i) {
    const Bad bad = insert_group_[i];
    if (!is_current(bad)) continue;
    TetCavity& cavity = cavities_[i];
    if (is_found[i] == 0) {
      if (round_.is_sliding && slide_ != nullptr) group_.push_back(bad);
      continue;
    }
    if (!cavity.is_current()) {
      queue(bad.tet);
      continue;
    }
    if (cavity.growth() > static_cast<std::ptrdiff_t>(room()) || !cavity.make()) continue;
    const std::vector<Index> placed = complex_.placed;
    queue_all(placed);
    smooth_around(placed);
  }
  insert_group_.clear();
}

void TetImprover::smooth_around(const std::vector<Index>& placed) {
  points_.clear();
  for (const Index tet : placed) {
    points_.insert(points_.end(), complex_.corners[tet].begin(), complex_.corners[tet].end());
  }
  std::sort(points_.begin(), points_.end());
  points_.erase(std::unique(points_.begin(), points_.end()), points_.end());
  // The new point has the largest index.
  for (std::size_t i = points_.size(); i-- > 0;) smooth(points_[i]);
}

bool TetImprover::try_corners(SlideTrial& trial, Index tet) const {
  return std::any_of(complex_.corners[tet].begin(), complex_.corners[tet].end(), [&](Index point) {
    return complex_.is_on_wall[point] != 0 && trial.climb_to(point, round_.target, round_.gain);
  });
}

// Tries those of the group that do not depend on each other, side by side; makes the moves that were found;
// keeps the others for the next time.
void TetImprover::slide_group() {
  std::erase_if(group_, [&](const Bad& bad) { return !is_current(bad); });
  std::vector<ImproveBox> boxes(group_.size());
  parallel_for(context_, group_.size(), [&](std::size_t i) { boxes[i] = slide_->reach(group_[i].tet); });
  std::vector<Bad> later;
  std::size_t count = 0;
  reach_.clear();
  for (std::size_t i = 0; i < group_.size(); ++i) {
    const Bad bad = group_[i];
    const ImproveBox& box = boxes[i];
    if (std::any_of(reach_.begin(), reach_.end(),
                    [&](const ImproveBox& other) { return other.meets(box); })) {
      later.push_back(bad);
      continue;
    }
    reach_.push_back(box);
    group_[count++] = bad;
  }
  std::vector<std::uint8_t> is_found(count, 0);
  parallel_for(context_, count,
               [&](std::size_t i) { is_found[i] = try_corners(trials_[i], group_[i].tet) ? 1 : 0; });
  for (std::size_t i = 0; i < count; ++i) {
    if (is_found[i] == 0) continue;
    slide_->make(trials_[i].move());
    queue_all(trials_[i].move().star);
  }
  group_ = std::move(later);
}

double TetImprover::share_below(double limit) const {
  std::size_t count = 0;
  for (Index t = 0; t < complex_.corners.size(); ++t) {
    count += complex_.is_live(t) && complex_.quality[t] < limit ? 1 : 0;
  }
  return static_cast<double>(count) / static_cast<double>(std::max<std::size_t>(complex_.live, 1));
}

std::vector<TetImprover::Bad> TetImprover::worst(double limit) const {
  std::vector<Bad> result;
  for (Index t = 0; t < complex_.corners.size(); ++t) {
    if (complex_.is_live(t) && complex_.quality[t] < limit) {
      result.push_back({complex_.quality[t], t, complex_.version[t]});
    }
  }
  std::sort(result.begin(), result.end(), [](const Bad& a, const Bad& b) { return b < a; });
  result.resize(std::min(result.size(), kFewestRescued + complex_.live / kTetsPerRescue));
  return result;
}

// The corners of all tetrahedra at a tetrahedron's corners, ascending.
std::vector<Index> TetImprover::points_around(Index tet) const {
  std::vector<Index> points, star;
  for (const Index corner : complex_.corners[tet]) {
    complex_.star(corner, star);
    for (const Index other : star) {
      points.insert(points.end(), complex_.corners[other].begin(), complex_.corners[other].end());
    }
  }
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
  return points;
}

void TetImprover::rescue(Index tet, double limit) {
  std::vector<Index> points = points_around(tet);
  const Tetrahedron corners = complex_.corners[tet];
  const auto is_corner = [&](Index point) {
    return std::find(corners.begin(), corners.end(), point) != corners.end();
  };
  // Its own points first, which may be enough.
  std::stable_partition(points.begin(), points.end(), is_corner);
  round_ = {kRescueTarget, true, 0, true, kRescueGain};
  for (const Index point : points) {
    if (complex_.quality[tet] >= limit) break;
    if (complex_.is_on_wall[point] == 0) {
      smoothing_.smooth(point, kRescueTarget);
    } else if (slide_ != nullptr &&
               (trials_[0].climb_to(point, kRescueTarget, kRescueGain) ||
                (is_corner(point) && trials_[0].search(point, kRescueTarget, kRescueGain)))) {
      slide_->make(trials_[0].move());
    }
  }
  round_.target = limit;
  std::vector<Index> star;
  for (const Index point : points) {
    complex_.star(point, star);
    queue_all(star);
  }
  drain();
}

void TetImprover::rescue(double limit) {
  for (int time = 0; time < kRescues; ++time) {
    for (const Bad& bad : worst(limit)) {
      context_.check_cancelled();
      if (is_current(bad)) rescue(bad.tet, limit);
    }
  }
}

}  // namespace periost
