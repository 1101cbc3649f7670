#pragma once
// Deformable contours: how a simplex mesh ends (paper, section 2.2; Delingette 1994). The dual of an open
// triangulation lacks neighbours at its border. Closing its contours gives it, for every border edge of the
// triangulation, a contour vertex in the middle of that edge, and for every border curve a face over the
// hole:
//   - a contour vertex has three neighbours, two along its contour and one inside; those two make the contour
//     a 1-simplex mesh;
//   - the dual of a contour vertex is the border edge; that of an edge along the contour, a border point;
//   - every operator then works as on a closed mesh. Removing the edge between a contour vertex and its inner
//     neighbour takes an edge out of the border.
#include <cstdint>
#include <vector>

#include "pipeline/data/grid_frame.h"
#include "pipeline/data/simplex_mesh.h"
#include "pipeline/geometry/simplex_walk.h"

namespace periost {

// Where a vertex stands: 2 a and 2 a + 1 are contour vertices on the image's border planes of axis a, index 0
// and index dims - 1.
inline constexpr std::uint8_t kFixedContour = 6;  // on a contour anywhere else: it never moves
inline constexpr std::uint8_t kInside = 7;        // on no contour

// Beside a mesh whose contours are closed. All vectors are empty if it has none.
struct Contours {
  std::vector<std::uint8_t> side;     // of vertices
  std::vector<std::uint8_t> is_hole;  // of faces
  std::vector<std::uint8_t>
      may_be_cut;  // of faces: 0 only if no contour cuts it; who merges faces keeps it so

  bool empty() const { return side.empty(); }
  bool is_on_contour(SimplexVertex v) const { return !empty() && side[index_of(v)] != kInside; }
  bool is_over_hole(SimplexFace f) const { return !empty() && is_hole[index_of(f)] != 0; }
};

// A contour vertex's row: its face over the hole has slot 2 in `face`, its inner neighbour slot 2 in
// `neighbour`; neighbours 0 and 1 follow and precede it around the hole. No operator that keeps clear of the
// faces over holes changes these slots.
inline constexpr int kHoleSlot = 2;

// Closes the contours of the dual of an open surface: appends contour vertices and faces over holes, changes
// no other number. A contour vertex gets the side of the border plane that both ends of its edge lie on
// within a millionth of a voxel, if any. Precondition: no dead elements. O(n).
Contours close_contours(SimplexMesh& mesh, const GridFrame& frame);

// Takes contour vertices and holes out again (they are dead afterwards), so that a mesh just closed and
// opened is the same after compact(). O(n).
void open_contours(SimplexMesh& mesh, const Contours& contours);

// Drops dead elements from both.
void compact(SimplexMesh& mesh, Contours& contours);

// The two contour vertices of face f, in the order of its walk around f (second after first), or none.
struct ContourEdge {
  SimplexVertex first = kNoVertex, second = kNoVertex;
  bool exists() const { return first != kNoVertex; }
};
ContourEdge contour_edge_of(const SimplexMesh& mesh, const Contours& contours, SimplexFace f);

// Joins decimated parts of one surface along their fixed contours, the paper's operator on two contours: two
// contour vertices whose border edges end in the same dual positions, bit by bit, vanish, their inner
// neighbours become neighbours, the border faces of the two sides become one. Contours that are left, on the
// image border, are joined where a cut met them. Inner vertices keep the order of the parts. Fixed contours
// without a counterpart stay. The whole is compact; fields are left out. Preconditions: compact parts; no
// edge but those of the contour joins two faces of a fixed contour, and each of these has two inner vertices
// at least (else two faces could come to share two edges). O(n log n) in contour vertices.
struct ContouredMesh {
  SimplexMesh mesh;
  Contours contours;
};
struct SewnMesh {
  ContouredMesh whole;
  std::vector<SimplexVertex> seam;  // inner vertices that gained a neighbour, ascending
};
SewnMesh sew(const std::vector<ContouredMesh>& parts);

}  // namespace periost
