#pragma once
// The ten worst elements of a metric, kept while it is measured.
#include <algorithm>
#include <vector>

#include "pipeline/data/quality_report.h"

namespace periost {

// Keeps the elements with the lowest or highest values; among equal values, the one added first. The result
// is sorted, worst first. O(1) for an element that is not among them.
class Extremes {
 public:
  enum class Side { kLowest, kHighest };
  static constexpr std::size_t kCount = 10;

  explicit Extremes(Side side) : side_(side) {}

  void add(std::uint64_t element, double value, Vec3 centre_mm) {
    if (worst_.size() == kCount && !is_worse(value, worst_.back().value)) return;
    const auto place = std::find_if(worst_.begin(), worst_.end(),
                                    [&](const WorstElement& other) { return is_worse(value, other.value); });
    worst_.insert(place, {element, value, centre_mm, {}});
    if (worst_.size() > kCount) worst_.pop_back();
  }
  std::vector<WorstElement> take() { return std::move(worst_); }

 private:
  bool is_worse(double a, double b) const { return side_ == Side::kLowest ? a < b : a > b; }

  Side side_;
  std::vector<WorstElement> worst_;
};

}  // namespace periost
