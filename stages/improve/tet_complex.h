#pragma once
// A tetrahedral mesh while it is being changed: flat arrays, neighbours across faces, and one primitive that
// replaces a set of tetrahedra by another one with the same outer faces.
//
// Faces without a neighbour are walls: the boundary of the mesh, and the faces between two regions, where
// neighbours are cut on purpose. No change crosses a wall, so walls stay face by face what they were.
// Slots of dropped tetrahedra are used again; `version` of a slot grows with every change of it.
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "pipeline/data/tet_mesh.h"
#include "pipeline/geometry/tet_faces.h"
#include "stages/improve/sine_quality.h"

namespace periost {

// Positions in the arrays of a tetrahedron, whose tables hold int.
inline std::size_t as_size(int i) {
  return static_cast<std::size_t>(i);
}

class TetComplex {
 public:
  // Takes corners, tetrahedra and regions; mid-side nodes are left out. O(n).
  // Preconditions: indices in range, positive volumes.
  explicit TetComplex(TetMesh mesh);

  std::vector<Vec3> position;             // of points
  std::vector<Tetrahedron> corners;       // of slots; [0] == kNoIndex: a free slot
  std::vector<TetNeighbours> neighbours;  // of slots; across the face opposite to corner k, kNoIndex: a wall
  std::vector<std::int32_t> region;       // of slots
  std::vector<double> quality;            // of slots: smallest sine
  std::vector<std::uint32_t> version;     // of slots
  std::vector<Index> tet_at;              // of points: one of its tetrahedra; kNoIndex: the point is not used
  std::vector<std::uint8_t> is_on_wall;   // of points
  std::size_t live = 0;                   // tetrahedra

  bool is_live(Index tet) const { return corners[tet][0] != kNoIndex; }
  int corner_of(Index tet, Index point) const;  // 0..3; precondition: the point is one of its corners
  bool has_corner(Index tet, Index point) const;
  int side_towards(Index tet, Index neighbour) const;  // k with neighbours[tet][k] == neighbour, or -1
  double measure(Index tet) const;                     // the quality from the positions
  double measure(const Tetrahedron& tet) const;
  // The tetrahedron seen from one of its corners.
  TetFan fan(Index tet, int corner) const;

  // The tetrahedra around a point, joined across faces that are no walls. Precondition: the point is used.
  void star(Index point, std::vector<Index>& tets) const;

  // The ring of an edge that is on no wall: tetrahedra in turn, right-handed about a -> b, and the points
  // around, ring[i] and ring[i + 1] in tets[i]. False when it meets a wall or is longer than `longest`.
  // Precondition: `tet` has both corners.
  bool ring(Index tet, Index a, Index b, std::size_t longest, std::vector<Index>& tets,
            std::vector<Index>& points) const;

  // Puts new tetrahedra of positive volume in the place of old ones. False, and nothing is changed, unless
  // their faces match one to one with the outer faces of the old ones and among themselves. The new ones'
  // slots are in `placed` afterwards. Points that no tetrahedron uses any more get tet_at == kNoIndex.
  // Precondition: `old` are live, different, of one region. O(old + new).
  bool replace(const std::vector<Index>& old, const std::vector<Tetrahedron>& fresh);
  std::vector<Index> placed;

  // Adds a point that no tetrahedron uses yet; drop_last_point() takes it back.
  Index add_point(Vec3 place);
  void drop_last_point();

  // Moves a point and measures its star anew.
  void move(Index point, Vec3 place, const std::vector<Index>& star);

  // Marks for callers: a set of slots that is emptied in constant time.
  void clear_marks() { ++stamp_; }
  bool mark(Index tet);  // false if it was marked
  bool is_marked(Index tet) const { return marks_[tet] == stamp_; }

 private:
  struct Face {
    Triangle key;          // sorted corners
    Index tet = kNoIndex;  // outside: a slot, or kNoIndex at a wall; inside: number of the new one
    int side = 0;
    bool is_outside = false;
    bool is_matched = false;
    Index other = kNoIndex;  // the face it matches
  };
  bool match_faces(const std::vector<Index>& old, const std::vector<Tetrahedron>& fresh);
  bool take_face(const Face& face);
  Index take_slot();

  std::vector<Index> free_slots_;
  std::vector<std::uint64_t> marks_;
  std::uint64_t stamp_ = 1;
  std::vector<Face> faces_;
  std::vector<Index> table_;  // open addressing into faces_
};

// Whether neighbours are mutual, share their faces, volumes are positive, qualities and counts are right; a
// text that says what is wrong, or empty. For tests and assertions.
std::string check_complex(const TetComplex& complex);

}  // namespace periost
