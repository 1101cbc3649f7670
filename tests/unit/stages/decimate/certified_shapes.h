#pragma once
// Small isosurfaces for the tests of the certified scheme, on an oblique, anisotropic grid far from the
// origin.
#include <cmath>

#include "pipeline/base/random.h"
#include "stages/marching_cubes/marching_cubes.h"

namespace periost::shapes {

inline GridFrame oblique_frame(std::array<std::int32_t, 3> dims, bool left_handed = false) {
  const double c = std::cos(0.4), s = std::sin(0.4);
  GridFrame frame{dims, {0.8, 0.9, 1.3}, {-120, 45, 310}, {}};
  frame.direction.column = {Vec3{c, s, 0}, Vec3{-s, c, 0}, Vec3{0, 0, left_handed ? -1.0 : 1.0}};
  return frame;
}

// The isosurface 0 of a function of the voxel index.
template <class Function>
Isosurface isosurface_of(std::array<std::int32_t, 3> dims, Function&& value, bool left_handed = false) {
  Image image{oblique_frame(dims, left_handed), {}};
  for (std::int32_t k = 0; k < dims[2]; ++k) {
    for (std::int32_t j = 0; j < dims[1]; ++j) {
      for (std::int32_t i = 0; i < dims[0]; ++i) {
        image.values.push_back(static_cast<float>(value(Vec3{double(i), double(j), double(k)})));
      }
    }
  }
  ThresholdRange range;
  range.lower = 0;
  return marching_cubes(image, range, {}, Context{});
}

inline Isosurface ellipsoid(bool left_handed = false) {
  return isosurface_of(
      {24, 24, 24},
      [](Vec3 p) {
        const Vec3 d = p - Vec3{11.6, 11.3, 11.8};
        return 9.1 - std::sqrt(d.x * d.x + 1.3 * d.y * d.y + 1.1 * d.z * d.z);
      },
      left_handed);
}

// A binary cube, turned against the grid, so that its faces are stairs.
inline Isosurface stairs() {
  return isosurface_of({28, 28, 28}, [](Vec3 p) {
    const Vec3 d = p - Vec3{13.5, 13.5, 13.5};
    const double c = std::cos(0.35), s = std::sin(0.35);
    const double x = c * d.x - s * d.y, y = s * d.x + c * d.y;
    return std::max({std::abs(x), std::abs(y), std::abs(d.z)}) <= 8.2 ? 1.0 : -1.0;
  });
}

// Two thin sheets less than a voxel apart, with holes where the grid misses them.
inline Isosurface near_sheets() {
  return isosurface_of({36, 36, 14}, [](Vec3 p) {
    const double z = p.z - 6.5 + 1.2 * std::sin(0.2 * p.x) * std::cos(0.17 * p.y);
    return 0.4 - std::min(std::abs(z - 0.7), std::abs(z + 0.7));
  });
}

// The same, larger: several regions of the certified scheme.
inline Isosurface large_sheets() {
  return isosurface_of({44, 44, 16}, [](Vec3 p) {
    const double z = p.z - 7.5 + 1.4 * std::sin(0.2 * p.x) * std::cos(0.17 * p.y);
    return 0.6 - std::min(std::abs(z - 1.1), std::abs(z + 1.1));
  });
}

inline Isosurface white_noise(std::uint64_t seed) {
  Random random(seed, 0);
  return isosurface_of({9, 8, 9}, [&](Vec3) { return random.uniform() - 0.5; });
}

}  // namespace periost::shapes
