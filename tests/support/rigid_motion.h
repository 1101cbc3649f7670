#pragma once
// A rotation, a translation and a scale for invariance tests.
#include <cmath>

#include "pipeline/data/vec.h"

namespace periost::test {

// Turns about the axis (1, 2, 3) by `angle` radians, scales, then moves.
inline Vec3 moved(Vec3 p, double angle = 0.7, double scale = 3.7, Vec3 shift = {120, -45, 1e3}) {
  const Vec3 axis = normalized(Vec3{1, 2, 3});
  const Vec3 turned =
      p * std::cos(angle) + cross(axis, p) * std::sin(angle) + axis * (dot(axis, p) * (1 - std::cos(angle)));
  return turned * scale + shift;
}

}  // namespace periost::test
