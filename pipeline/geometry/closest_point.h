#pragma once
// Closest points of single shapes.
#include "pipeline/data/vec.h"

namespace periost {

// The point of triangle (a, b, c) closest to p; right for degenerate triangles too.
Vec3 closest_point_on_triangle(Vec3 p, Vec3 a, Vec3 b, Vec3 c);

}  // namespace periost
