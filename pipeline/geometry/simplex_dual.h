#pragma once
// The duality between triangulations and simplex meshes (Delingette 1997, section 2.2), and the upkeep of a
// simplex mesh as a whole. Triangle i becomes vertex i, point j becomes face j, and the corners of a triangle
// keep their order, so the dual of the dual is the same mesh. Points that no triangle uses are dropped and
// the faces renumbered in order; nothing else changes its number.
#include <cstdint>
#include <string>
#include <vector>

#include "pipeline/data/simplex_mesh.h"
#include "pipeline/data/surface_mesh.h"

namespace periost {

// The simplex mesh dual to `surface`, closed or open, of any number of components. Its vertices lie at the
// triangles' centroids, dual_position holds the points, face_fields the point fields.
// Throws Error{kQuality, "surface.not_manifold"} naming the place in LPS mm where an edge has more than two
// triangles, neighbours disagree in orientation, a triangle repeats a corner, or sheets touch in one point;
// and "surface.bad_index" when a triangle names a point that does not exist. O(n) for bounded valences.
SimplexMesh dual_simplex_mesh(const SurfaceMesh& surface);

// The triangulation dual to the live part of `mesh`, with points at dual_position. dual_triangulation(
// dual_simplex_mesh(s)) has the points and triangles of s, bit by bit, if s has no unused point.
SurfaceMesh dual_triangulation(const SimplexMesh& mesh);

// Drops dead vertices and faces; the rest keeps its order. O(n).
void compact(SimplexMesh& mesh);

// Connected components of the live part, numbered in the order of their first vertex.
struct SimplexComponents {
  std::vector<std::uint32_t> of_vertex;  // component of each vertex; 0xFFFFFFFF for a dead one
  std::uint32_t count = 0;
};
SimplexComponents components_of(const SimplexMesh& mesh);

// V - E + F of the live part, the Euler number of the surface (2 for a sphere); contour edges count.
std::int64_t euler_number(const SimplexMesh& mesh);

// The first violated invariant of the live part, as a sentence for a developer, or an empty string: arrays of
// equal size; three distinct neighbours, mutual, across the edge that both ends see between the same two
// faces; each face's walk closes (or runs from contour to contour) after `valence` vertices, at least three
// if closed; two faces share at most one edge. O(n log n).
std::string check_simplex_mesh(const SimplexMesh& mesh);

}  // namespace periost
