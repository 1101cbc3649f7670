#pragma once
// Exact answers to yes-or-no questions about points, whatever the rounding: on which side of a plane, do two
// triangles meet. A floating-point filter decides nearly always; where it cannot, the determinant is summed
// exactly as a floating-point expansion (Priest 1991, Shewchuk 1997).
//
// Preconditions of all: finite coordinates whose differences lie between 1e-90 and 1e90 in magnitude (or are
// zero), so that no product of three under- or overflows. Pure functions; a few nanoseconds when the filter
// decides, about a microsecond otherwise.
#include <array>
#include <vector>

#include "pipeline/data/surface_mesh.h"

namespace periost {

struct Vec2 {
  double x = 0, y = 0;
};

using TriangleCorners = std::array<Vec3, 3>;

// +1 when a, b, c turn counter-clockwise, -1 clockwise, 0 when they lie on one line.
int orient2d(Vec2 a, Vec2 b, Vec2 c);

// +1 when d lies on the side of the plane a, b, c to which (b - a) x (c - a) points, -1 on the other, 0 on
// it. So +1 is a tetrahedron of positive volume in VTK's order.
int orient3d(Vec3 a, Vec3 b, Vec3 c, Vec3 d);

// The three points lie on one line (or coincide).
bool is_degenerate(const TriangleCorners& triangle);

// The closed segment p q and the closed triangle have a common point. Degenerate ones are allowed.
bool segment_meets_triangle(Vec3 p, Vec3 q, const TriangleCorners& triangle);

// The closed triangles have a common point: touching counts, and so does overlapping in one plane.
bool triangles_meet(const TriangleCorners& a, const TriangleCorners& b);

// Whether two triangles of one mesh have a common point other than the corners and the edge that they share
// by index. With no corner in common that is triangles_meet; with one, whether they cross or overlap beyond
// it; with two, whether they are folded onto each other in one plane; with three, always. This is what a
// self-intersection of a surface means here.
// Precondition: the indices are valid; each triangle has three different ones.
bool triangles_intersect(const std::vector<Vec3>& points, const Triangle& a, const Triangle& b);

// Which side of the closed surface a point lies on, by the exact parity of crossings of a ray along +x:
// whether an odd number of `triangles` is crossed. Rays through edges and corners are counted right.
// Precondition: the point is on none of the triangles. O(triangles).
bool is_inside_by_parity(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles, Vec3 point);

// One step of it: whether the ray from `point` along +x crosses the triangle.
bool ray_crosses(const TriangleCorners& triangle, Vec3 point);

}  // namespace periost
