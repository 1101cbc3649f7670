#pragma once
// The forward certificate: a proof that every point of a new triangle lies within a tolerance of the
// isosurface (Periost's algorithm notes, section 5 rule 3).
//
// Overlay. Let d be a direction and T a triangle not parallel to it. Starting at the isosurface triangle
// under T's barycentre, collect isosurface triangles across every edge whose shadow along d meets T. On the
// overlay of T with one of them the height difference along d is linear, so it is within the tolerance
// everywhere if it is so at the overlay's corners; and the distance to one triangle is a convex function, so
// T is within the tolerance all over the overlay if its corners are so to one triangle. No edge of the
// collected patch's border has a shadow that meets T, so the degree of the projection of the patch onto T's
// plane is the same at every point of T; if it is at least 1 at one point, each point of T lies in an
// overlay, and so within the tolerance. Tried along the mean isosurface normal first, along T's own last. An
// overlay that fails names a point of T, its highest; where no isosurface triangle is within the tolerance of
// that point, T is refuted and nothing more is tried.
//
// Bisection. The distance to one triangle is a convex function, so a triangle whose three corners lie within
// the tolerance of the same isosurface triangle lies within it altogether. T's longest edge is bisected until
// that holds for each piece. A corner that is too far refutes T.
#include <array>
#include <vector>

#include "stages/decimate/certificate_reference.h"

namespace periost {

// Buffers of one thread.
struct ForwardScratch {
  std::vector<std::uint32_t> stamp;  // of isosurface triangles
  std::uint32_t tick = 0;
  std::vector<Index> queue;
  std::vector<Index> pool;  // lists of near triangles, one after the other
  std::vector<Index> found;
};

// A dual triangle with what is stored at its corners: the nearest isosurface triangle of each.
struct DualTriangle {
  std::array<Vec3, 3> corner;
  std::array<Index, 3> nearest;
};

enum class Answer { kProved, kRefuted, kUnknown };

// What the overlay along `direction` (unit length) says of T. Sound both ways, not complete.
Answer certify_by_overlay(const Reference& reference, const DualTriangle& triangle, Vec3 direction,
                          double tolerance, ForwardScratch& scratch);

// Whether bisection down to `depth` proves T. Sound; complete as the depth grows but for limit cases.
bool certify_by_bisection(const Reference& reference, const std::array<Vec3, 3>& triangle, double tolerance,
                          int depth, ForwardScratch& scratch);

// An overlay, bisection, the other overlay in turn. `tolerance` in mm, > 0; keep 1e-4 of it for rounding.
bool certify_forward(const Reference& reference, const DualTriangle& triangle, double tolerance,
                     ForwardScratch& scratch);

}  // namespace periost
