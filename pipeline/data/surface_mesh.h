#pragma once
// A triangulated surface in LPS millimetres.
#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "pipeline/data/vec.h"

namespace periost {

using Index = std::uint32_t;
inline constexpr Index kNoIndex = 0xFFFFFFFFu;

using Triangle = std::array<Index, 3>;

// Values attached to points or elements, by name, one number each.
using Fields = std::map<std::string, std::vector<float>>;

// Seen from outside, the corners of a triangle run counter-clockwise (normals outward).
struct SurfaceMesh {
  std::vector<Vec3> points;
  std::vector<Triangle> triangles;
  Fields point_fields;
  Fields triangle_fields;
  double voxel_mm = 0;    // largest voxel side of the image behind it; 0: none
  bool was_read = false;  // from a file, not made by the chain: what is wrong with it is the input's fault
};

}  // namespace periost
