#pragma once
// How tetrahedra hang together: neighbours across faces, the boundary, connected bodies, and the mid-side
// nodes of second-order elements. Linear time, no third party, independent of threads.
#include <array>
#include <cstdint>
#include <vector>

#include "pipeline/data/tet_mesh.h"

namespace periost {

// Corners of the face opposite to corner k of a tetrahedron of positive volume, outward.
inline constexpr std::array<std::array<int, 3>, 4> kTetFace{{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};
// The two corners of mid-side node k (VTK's order).
inline constexpr std::array<std::array<int, 2>, 6> kTetEdge{{{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}};

// The face opposite to corner k, outward.
inline Triangle face_of(const Tetrahedron& tet, int k) {
  const auto& corner = kTetFace[static_cast<std::size_t>(k)];
  return {tet[static_cast<std::size_t>(corner[0])], tet[static_cast<std::size_t>(corner[1])],
          tet[static_cast<std::size_t>(corner[2])]};
}

using TetNeighbours = std::array<Index, 4>;

// Per tetrahedron, its neighbour across the face opposite to corner k, or kNoIndex at the boundary (and where
// more than two share a face, which no valid mesh has). Precondition: indices below `points`.
std::vector<TetNeighbours> tet_neighbours(const std::vector<Tetrahedron>& tets, std::size_t points);

// One face of one tetrahedron at the boundary.
struct BoundaryFace {
  Index tet = 0;
  int opposite = 0;  // the corner that the face lacks
};

// By tetrahedron, then by corner.
std::vector<BoundaryFace> boundary_faces(const std::vector<TetNeighbours>& neighbours);

// The faces between two regions, each once, outward from the region with the smaller number. Precondition:
// `neighbours` are the mesh's.
std::vector<Triangle> faces_between_regions(const TetMesh& mesh,
                                            const std::vector<TetNeighbours>& neighbours);

// Per tetrahedron, the number of its body, from 0 in the order of the bodies' first tetrahedra; bodies are
// joined across faces.
std::vector<std::uint32_t> tet_components(const std::vector<TetNeighbours>& neighbours);

// Six times the signed volume: positive in VTK's order.
inline double six_volumes(Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
  return dot(b - a, cross(c - a, d - a));
}

// Makes a first-order mesh second-order: a node in the middle of every edge, shared by its tetrahedra,
// appended to the points in the order of the edges' first use. Point fields are averaged. A mesh that is of
// second order already gets its nodes moved to the middles instead.
void add_midside_nodes(TetMesh& mesh);

}  // namespace periost
