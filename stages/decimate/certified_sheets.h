#pragma once
// Self-intersection guard: new triangles against those around the ring and against near sheets, which are
// found in a grid of the output's triangles.
#include <vector>

#include "stages/decimate/certified_mesh.h"

namespace periost {

// Buffers of one thread.
// An axis-parallel box; empty at first.
struct Box {
  Vec3 lo{1e300, 1e300, 1e300}, hi{-1e300, -1e300, -1e300};

  void add(const Box& o) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      lo[axis] = std::min(lo[axis], o.lo[axis]);
      hi[axis] = std::max(hi[axis], o.hi[axis]);
    }
  }
  bool meets(const Box& o) const {
    return lo.x <= o.hi.x && o.lo.x <= hi.x && lo.y <= o.hi.y && o.lo.y <= hi.y && lo.z <= o.hi.z &&
           o.lo.z <= hi.z;
  }
};

struct SheetScratch {
  std::vector<std::uint32_t> stamp;  // of output triangles
  std::uint32_t tick = 0;
  std::vector<Vec3> corner;  // of the new triangles, three each
  std::vector<Box> box;      // of the new triangles
};

// A grid over the working mesh. A triangle stands in every cell that its bounding box has touched since it
// was entered; those removed are dropped when they are met. Moves in disjoint regions whose borders lie on
// cell borders touch disjoint cells.
class SheetGrid {
 public:
  // Cells have `side_voxels` voxels a side, in the image's own axes; more where that would be more than four
  // million cells. O(triangles + cells).
  SheetGrid(const Reference& reference, const CertifiedMesh& mesh, int side_voxels);

  // Whether a new triangle of the proposal would meet a triangle that stays, or another new one, in more than
  // what they share; by exact predicates. `around`: triangles that share a vertex with the ring. Tests
  // between neighbours are left out where all their normals lie in one narrow cone.
  bool would_intersect(const CertifiedMesh& mesh, const Proposal& proposal, const std::vector<Index>& around,
                       SheetScratch& scratch);

  // Enters all living triangles anew, and nothing else.
  void refill(const CertifiedMesh& mesh);

  // Voxels a side; cell borders are at its multiples in the image's index space.
  double side() const { return side_; }

  // Enters the triangles of a proposal that has been applied.
  void insert(const CertifiedMesh& mesh, const Proposal& proposal);

 private:
  struct Range {
    std::array<std::int32_t, 3> lo, hi;  // cells, inclusive
  };
  Range range_of(const Vec3* begin, const Vec3* end) const;
  void insert(Index triangle, const std::array<Vec3, 3>& corners);
  bool meets_sheets(const CertifiedMesh& mesh, const Proposal& proposal, SheetScratch& scratch);

  // Visits the lists of a range until `visit` returns false; whether none did.
  template <class Visit>
  bool for_cells(const Range& range, Visit&& visit) {
    for (std::int32_t k = range.lo[2]; k <= range.hi[2]; ++k) {
      for (std::int32_t j = range.lo[1]; j <= range.hi[1]; ++j) {
        for (std::int32_t i = range.lo[0]; i <= range.hi[0]; ++i) {
          const std::size_t row =
              static_cast<std::size_t>(j) + static_cast<std::size_t>(count_[1]) * static_cast<std::size_t>(k);
          if (!visit(cells_[static_cast<std::size_t>(i) + static_cast<std::size_t>(count_[0]) * row])) {
            return false;
          }
        }
      }
    }
    return true;
  }

  GridFrame frame_;
  double side_ = 2;  // voxels
  std::array<std::int32_t, 3> first_{}, count_{};
  std::vector<std::vector<Index>> cells_;
};

}  // namespace periost
