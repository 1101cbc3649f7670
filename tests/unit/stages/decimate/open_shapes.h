#pragma once
// Open isosurfaces for the tests of contours: they end on the image border, on an oblique, anisotropic grid
// off the origin.
#include <array>
#include <cmath>

#include "stages/marching_cubes/marching_cubes.h"

namespace periost::shapes {

// Where depth(p) >= 0, p in voxels.
template <class Depth>
Isosurface open_shape(Vec3 origin, std::array<std::int32_t, 3> dims, Depth&& depth,
                      bool left_handed = false) {
  const double c = std::cos(0.4), s = std::sin(0.4);
  Image image{
      {dims, {0.9, 1.1, 1.3}, origin, {{Vec3{c, 0, s}, {0, left_handed ? -1.0 : 1.0, 0}, {-s, 0, c}}}}, {}};
  for (std::int32_t k = 0; k < dims[2]; ++k) {
    for (std::int32_t j = 0; j < dims[1]; ++j) {
      for (std::int32_t i = 0; i < dims[0]; ++i)
        image.values.push_back(static_cast<float>(depth(Vec3{double(i), double(j), double(k)})));
    }
  }
  return marching_cubes(image, {.lower = 0}, {.open = true}, Context());
}

}  // namespace periost::shapes
