#pragma once
// Isosurfaces of small binary shapes, with an origin off zero, made at run time.
#include "pipeline/data/isosurface.h"
#include "pipeline/data/mask.h"
#include "stages/marching_cubes/marching_cubes.h"

namespace periost::test {

// The isosurface of the voxels whose centres are inside(p), p in voxels from the middle of a cubic grid.
template <class Inside>
Isosurface binary_shape(std::int32_t size, Vec3 spacing, Inside inside) {
  Mask mask;
  mask.frame.dims = {size, size, size};
  mask.frame.spacing = spacing;
  mask.frame.origin = {-40, 12.5, 333};
  mask.inside.resize(mask.frame.voxel_count());
  const double middle = 0.5 * (size - 1);
  for (std::int32_t k = 0; k < size; ++k) {
    for (std::int32_t j = 0; j < size; ++j) {
      for (std::int32_t i = 0; i < size; ++i) {
        mask.inside[mask.frame.offset(i, j, k)] = inside(Vec3{i - middle, j - middle, k - middle}) ? 1 : 0;
      }
    }
  }
  return marching_cubes(nullptr, mask, {}, Context());
}

inline Isosurface binary_ball(double radius, Vec3 spacing = {1, 1, 1}) {
  return binary_shape(static_cast<std::int32_t>(2 * radius) + 6, spacing,
                      [&](Vec3 p) { return norm(p) <= radius; });
}

inline Isosurface binary_torus(double major, double minor) {
  return binary_shape(static_cast<std::int32_t>(2 * (major + minor)) + 6, {1, 1, 1}, [&](Vec3 p) {
    const double ring = std::sqrt(p.x * p.x + p.y * p.y) - major;
    return ring * ring + p.z * p.z <= minor * minor;
  });
}

// Two balls that do not touch.
inline Isosurface two_balls() {
  return binary_shape(40, {1, 1, 1}, [&](Vec3 p) {
    return norm(p - Vec3{-9, -8, -7}) <= 8 || norm(p - Vec3{9, 8, 8}) <= 7;
  });
}

}  // namespace periost::test
