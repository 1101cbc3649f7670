#pragma once
// The working simplex mesh of the certified scheme, seen from its dual: one linked triangle per simplex
// vertex, one stored dual vertex per simplex face. A move is described as a Proposal, which replaces a few
// triangles; nothing changes until it is applied, so nothing is ever undone.
#include <array>
#include <cstdint>
#include <optional>
#include <type_traits>
#include <vector>

#include "stages/decimate/certificate_reference.h"

namespace periost {

// Where a point stands: not on a contour, on one that it may move along, or on one where it stays.
inline constexpr std::uint8_t kOffContour = 0, kOnContour = 1, kPinned = 2;

struct CertifiedMesh {
  std::vector<LinkedTriangle> triangles;  // simplex vertices; corner[0] == kNoIndex when removed
  std::vector<Vec3> points;               // dual vertices: one per simplex face
  std::vector<Index> nearest;             // of points: the isosurface triangle near it
  // Of points: one triangle, on a contour the first one counter-clockwise; kNoIndex when removed.
  std::vector<Index> incident;
  // Of points: triangles there, 255 when more. On a contour three more, so that six is straight on there too.
  std::vector<std::uint8_t> valence;
  std::vector<std::uint8_t> is_locked;  // of points: borders of a region, and what cannot be decimated
  std::vector<std::uint8_t> contour;    // of points: kOffContour .. kPinned; empty for a closed surface
  // Of points: raised when a triangle at it is replaced, or when it moves by more than the least step (mm)
  // that gives moves refused before a new chance.
  std::vector<std::uint32_t> version;
  double least_step = 0;

  bool is_on_contour(Index v) const { return !contour.empty() && contour[v] != kOffContour; }
};

// The mesh that is the isosurface itself; distance 0 everywhere. A point where contours touch is locked.
CertifiedMesh make_certified_mesh(const Reference& reference);

// One bit for a number. Those of elements near one another differ mostly, so that sets without a common bit
// are soon known to have no common element.
inline std::uint64_t mark_of(std::uint64_t number) {
  return std::uint64_t{1} << number % 64;
}

// A list of fixed capacity on the stack.
template <class T, std::size_t Capacity>
class FixedList {
 public:
  void clear() {
    size_ = 0;
    marks_ = 0;
  }
  bool is_full() const { return size_ == Capacity; }
  void push_back(const T& value) {  // precondition: !is_full()
    items_[size_++] = value;
    if constexpr (std::is_integral_v<T>) marks_ |= mark_of(value);
  }
  std::size_t size() const { return size_; }
  const T& operator[](std::size_t i) const { return items_[i]; }
  const T* begin() const { return items_.data(); }
  const T* end() const { return items_.data() + size_; }
  bool contains(const T& value) const {
    if ((marks_ & mark_of(value)) == 0) return false;
    for (const T& item : *this) {
      if (item == value) return true;
    }
    return false;
  }

 private:
  std::array<T, Capacity> items_;
  std::size_t size_ = 0;
  std::uint64_t marks_ = 0;  // of all items, where these are numbers
};

// Rings with more than this many triangles are left as they are; the criterion on valences (3..9) forbids
// them among the results, and marching cubes makes none.
inline constexpr std::size_t kMaxStar = 24;
inline constexpr std::size_t kMaxRing = 2 * kMaxStar;

// The triangles around a vertex, counter-clockwise, and the vertices of its link: triangle i has the corners
// (v, link[i], link[i + 1]).
struct Star {
  FixedList<Index, kMaxStar> triangle;
  FixedList<Index, kMaxStar> link;
};
// False at a contour, or when the star is too large.
bool gather_star(const CertifiedMesh& mesh, Index vertex, Star& star);
// At a contour too: the link then has one vertex more than there are triangles; its first follows the vertex
// along the contour (surface on the left), its last precedes it. False only when the star is too large.
bool gather_ring(const CertifiedMesh& mesh, Index vertex, Star& ring);

enum class MoveKind { kRemoval, kSwap, kRelocation, kInsertion };

// Sums over triangles of how far their smallest angles fall short (certified_guard.h).
struct AngleDeficits {
  double sum = 0, under_floor = 0;
};

// A replacement of the triangles `before` by `after`, which keep some of the ids. An insertion brings in ids
// of dead elements as well.
struct Proposal {
  MoveKind kind = MoveKind::kRelocation;
  FixedList<Index, kMaxRing> before;          // ids of triangles
  FixedList<Index, kMaxRing> after;           // ids, a subset of `before` unless something is inserted
  FixedList<LinkedTriangle, kMaxRing> cells;  // their records after the move
  FixedList<Index, kMaxRing> rim;             // vertices that keep their place, each once
  Index moved = kNoIndex;                     // the vertex that gets `place`, or none
  Index removed = kNoIndex;                   // the vertex that vanishes, or none
  Vec3 place;
  Index place_nearest = kNoIndex;
  struct ValenceChange {
    Index vertex;
    int by;
  };
  FixedList<ValenceChange, 4> valence_changes;
  std::optional<AngleDeficits> deficits_before;  // once meets_angles has looked: the same for every place

  // Empties it for another move.
  void begin(MoveKind next) {
    kind = next;
    before.clear();
    after.clear();
    cells.clear();
    rim.clear();
    valence_changes.clear();
    deficits_before.reset();
    moved = removed = kNoIndex;
  }
  int valence_of(const CertifiedMesh& mesh, Index vertex) const {
    for (const auto& change : valence_changes) {
      if (change.vertex == vertex) return mesh.valence[vertex] + change.by;
    }
    return mesh.valence[vertex];
  }
  Vec3 point_of(const CertifiedMesh& mesh, Index vertex) const {
    return vertex == moved ? place : mesh.points[vertex];
  }
  Index nearest_of(const CertifiedMesh& mesh, Index vertex) const {
    return vertex == moved ? place_nearest : mesh.nearest[vertex];
  }
  // The record of a triangle after the move: its new one, or the mesh's.
  const LinkedTriangle& cell_of(const CertifiedMesh& mesh, Index triangle) const {
    for (std::size_t i = 0; i < after.size(); ++i) {
      if (after[i] == triangle) return cells[i];
    }
    return mesh.triangles[triangle];
  }
};

inline std::array<Vec3, 3> corners_now(const CertifiedMesh& mesh, Index triangle) {
  const auto& c = mesh.triangles[triangle].corner;
  return {mesh.points[c[0]], mesh.points[c[1]], mesh.points[c[2]]};
}
// Where its simplex vertex stands.
inline Vec3 barycentre(const CertifiedMesh& mesh, Index triangle) {
  const auto c = corners_now(mesh, triangle);
  return (c[0] + c[1] + c[2]) / 3;
}
// Of a triangle's record as it would be after the move.
inline std::array<Vec3, 3> corners_after(const CertifiedMesh& mesh, const Proposal& proposal,
                                         const LinkedTriangle& cell) {
  return {proposal.point_of(mesh, cell.corner[0]), proposal.point_of(mesh, cell.corner[1]),
          proposal.point_of(mesh, cell.corner[2])};
}

// Whether a vertex of a star's or ring's link is locked.
bool is_any_locked(const CertifiedMesh& mesh, const FixedList<Index, kMaxStar>& link);

// Each describes a move without its place; false when the result would not be a simplicial manifold (the
// link condition), or when a vertex of it is locked. Neither end of a removed edge may lie on a contour, nor
// may a vertex that is relocated: certified_contour_moves.h has those.
// T1^2: the edge of triangle t opposite to corner k is contracted, in the dual; its two faces become one.
bool propose_removal(const CertifiedMesh& mesh, Index triangle, std::size_t k, Proposal& proposal);
// Whether a proposed removal makes a cycle of three edges that bounds no triangle. A handle or a branch is
// then three edges around, the least that the link condition lets it be; nothing there can be removed any
// more, and slivers stay.
bool makes_neck(const CertifiedMesh& mesh, const Proposal& proposal);
// T7^2: that edge is flipped, in the dual.
bool propose_swap(const CertifiedMesh& mesh, Index triangle, std::size_t k, Proposal& proposal);
// T2^2, the inverse of T1^2: a dual vertex is inserted on that edge. `vertex` and the two `triangles` are
// dead ones that come to life.
bool propose_insertion(const CertifiedMesh& mesh, Index triangle, std::size_t k, Index vertex,
                       const std::array<Index, 2>& triangles, Proposal& proposal);
// One dual vertex moves; the topology stays.
bool propose_relocation(const CertifiedMesh& mesh, Index vertex, Proposal& proposal);

void apply(const Proposal& proposal, CertifiedMesh& mesh);

}  // namespace periost
