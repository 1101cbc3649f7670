#pragma once
// How tetrahedra hang together: faces, neighbours and the boundary.
#include <array>
#include <vector>

#include "pipeline/data/tet_mesh.h"

namespace periost {

// Corners of the face opposite to each corner, outward for a positive volume.
inline constexpr std::array<std::array<std::size_t, 3>, 4> kTetFaces{
    {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

// A pair of tetrahedra that share a face; first < second.
struct TetPair {
  Index first = 0, second = 0;
};

// What the faces of a tetrahedral mesh say. O(n).
struct TetFaces {
  std::vector<TetPair> interior;   // one per face used by exactly two tetrahedra
  std::vector<Triangle> boundary;  // faces used once, outward when the tetrahedron is not inverted
  std::size_t overused = 0;        // faces used by three or more
};

// Both lists are sorted by the faces' corners, so they do not depend on anything but the mesh. Precondition:
// indices below `points`, fewer than 2^30 tetrahedra.
TetFaces tet_faces(const std::vector<Tetrahedron>& tets, std::size_t points);

}  // namespace periost
