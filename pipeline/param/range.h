#pragma once
// The values that a parameter may take, and whether it must be given.
#include <limits>
#include <string>

namespace periost {

// An interval of numbers. For a quantity it bounds the number in the unit the user wrote (0.3 of `0.3
// voxel`), so bounds other than 0 suit quantities with one unit only. For lists it bounds every element.
// Names, switches and choices take any().
struct Range {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool min_excluded = false;
  bool max_excluded = false;
  bool is_required = false;  // the key has no sensible default: leaving it out is an error

  static constexpr Range any() { return {}; }
  static constexpr Range above(double bound) { return Range{.min = bound, .min_excluded = true}; }
  static constexpr Range at_least(double bound) { return Range{.min = bound}; }
  static constexpr Range below(double bound) { return Range{.max = bound, .max_excluded = true}; }
  static constexpr Range at_most(double bound) { return Range{.max = bound}; }
  // Both ends included.
  static constexpr Range between(double low, double high) { return Range{.min = low, .max = high}; }
  static constexpr Range fraction() { return between(0, 1); }
  // Any value, but one must be given (`path`).
  static constexpr Range required() { return Range{.is_required = true}; }
  // This interval, and a value must be given.
  constexpr Range and_required() const {
    Range range = *this;
    range.is_required = true;
    return range;
  }

  constexpr bool contains(double value) const {
    return (min_excluded ? value > min : value >= min) && (max_excluded ? value < max : value <= max);
  }
  constexpr bool is_bounded() const { return contains(-kHuge) == false || contains(kHuge) == false; }
  // "above 0", "from 0 to 1", "at least 3"; empty for any().
  std::string text() const;

 private:
  static constexpr double kHuge = std::numeric_limits<double>::max();
};

}  // namespace periost
