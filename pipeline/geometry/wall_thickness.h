#pragma once
// How thick a body is at a point near two of its sides.
#include <optional>

#include "pipeline/data/surface_mesh.h"

namespace periost {

// The thickness of the wall that holds p, mm: from the closest point of the surface to the closest one behind
// p that faces the other way (at more than 120 degrees). Nothing when p is outside the body, or no such two
// points lie within `within_mm` of p. For the few worst elements of a report: O(triangles) each. Pure.
// Preconditions: the surface is oriented outwards, p is finite, within_mm > 0.
std::optional<double> wall_thickness(const SurfaceMesh& surface, Vec3 p, double within_mm);

}  // namespace periost
