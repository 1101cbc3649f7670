#pragma once
// Self-intersection guard: new triangles against those around the ring and against near sheets, which are
// found in a grid of the output's triangles.
#include <vector>

#include "pipeline/base/context.h"
#include "stages/decimate/certified_mesh.h"

namespace periost {

// An axis-parallel box; empty at first.
struct Box {
  Vec3 lo{1e300, 1e300, 1e300}, hi{-1e300, -1e300, -1e300};

  void add(Vec3 point) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      lo[axis] = std::min(lo[axis], point[axis]);
      hi[axis] = std::max(hi[axis], point[axis]);
    }
  }
  void add(const Box& o) {
    add(o.lo);
    add(o.hi);
  }
  // One branch for all axes: each alone is hard to foresee.
  bool meets(const Box& o) const {
    const double gap =
        std::max({lo.x - o.hi.x, o.lo.x - hi.x, lo.y - o.hi.y, o.lo.y - hi.y, lo.z - o.hi.z, o.lo.z - hi.z});
    return gap <= 0;
  }
};

// A triangle with what tests of it against others ask for again and again.
struct Facet {
  std::array<Vec3, 3> corner;
  Vec3 area;            // twice its area long
  double squared_size;  // of the longest edge
  std::uint64_t marks;  // bits of its corners: triangles without a common one have no common corner
};

// Buffers of one thread.
struct SheetScratch {
  std::vector<std::uint32_t> stamp;  // of output triangles
  std::uint32_t tick = 0;
  Box grid_box;              // of the proposal, in cells
  bool is_watched = true;    // whether the proposal comes to a cell that is
  std::vector<Facet> facet;  // the new triangles
  std::vector<Box> box;      // of the new triangles
};

// The isosurface triangles that have another, which faces away from them, within `gap` (mm) at the most:
// those on thin walls, in narrow clefts and at sharp edges. O(n), on all threads.
std::vector<Index> close_sheets(const Reference& reference, double gap, const Context& context);

// A grid over the working mesh. A triangle stands in every cell that its bounding box has touched since it
// was entered; those removed are dropped when they are met. Moves in disjoint regions whose borders lie on
// cell borders touch disjoint cells.
class SheetGrid {
 public:
  // Cells have `side_voxels` voxels a side, in the image's own axes; more where that would be more than four
  // million cells. O(triangles + cells).
  SheetGrid(const Reference& reference, const CertifiedMesh& mesh, int side_voxels);

  // A grid that watches only cells within `reach` (mm) of some isosurface triangles. A surface within t of
  // the isosurface on both sides can meet itself only where two sheets of that are within 2 t of each other,
  // or where it folds over, which its own criterion refuses: with close_sheets(reference, 2 t) hardly any
  // intersection goes unseen, and what does is for a check of the whole to find.
  SheetGrid(const Reference& reference, const CertifiedMesh& mesh, int side_voxels,
            const std::vector<Index>& close, double reach);

  // Finds where would_intersect will look for this proposal, and has that memory on its way. To be called
  // before it, with the proposal's place and the same scratch.
  void approach(const CertifiedMesh& mesh, const Proposal& proposal, SheetScratch& scratch) const;

  // Whether a new triangle of the proposal would meet a triangle that stays, or another new one, in more than
  // what they share; by exact predicates. `around`: triangles that share a vertex with the ring. Tests
  // between neighbours are left out where all their normals lie in one narrow cone.
  bool would_intersect(const CertifiedMesh& mesh, const Proposal& proposal, const std::vector<Index>& around,
                       SheetScratch& scratch);

  // Leaves in each cell only living triangles whose box meets it; all of these stand there already. On all
  // threads.
  void purge(const CertifiedMesh& mesh, const Context& context);

  // Voxels a side; cell borders are at its multiples in the image's index space.
  double side() const { return side_; }

  // Enters the triangles of a proposal that has been applied, and for which approach was called before.
  void insert(const CertifiedMesh& mesh, const Proposal& proposal, const SheetScratch& scratch);
  // Enters one triangle, wherever it stood before.
  void insert(const CertifiedMesh& mesh, Index triangle);

 private:
  // A triangle and the part of the cell that its box takes: 128 steps a side, one byte an axis, so that most
  // tests read nothing else.
  struct Entry {
    Index triangle;
    std::uint32_t lo, hi;
  };

  // A point in cells from the grid's corner.
  Vec3 to_grid(Vec3 p) const {
    return {dot(row_[0], p) + shift_.x, dot(row_[1], p) + shift_.y, dot(row_[2], p) + shift_.z};
  }
  std::size_t choose_cells(const CertifiedMesh& mesh, const GridFrame& frame);
  void lay_out(const Reference& reference, const CertifiedMesh& mesh);
  void watch(const Box& box);
  void fill(const CertifiedMesh& mesh);
  Box box_in_cells(const CertifiedMesh& mesh, Index triangle) const;
  bool meets_sheets(const CertifiedMesh& mesh, const Proposal& proposal, SheetScratch& scratch);
  struct Range {
    std::array<std::int32_t, 3> first, last;  // cells, inclusive
  };
  Range range_of(const Box& box) const;
  std::size_t row_of(std::int32_t j, std::int32_t k) const {
    return static_cast<std::size_t>(count_[0]) *
           (static_cast<std::size_t>(j) + static_cast<std::size_t>(count_[1]) * static_cast<std::size_t>(k));
  }
  template <class Visit>
  bool for_cells(const Box& box, Visit&& visit);

  double side_ = 2;          // voxels
  std::array<Vec3, 3> row_;  // from LPS mm to cells
  Vec3 shift_;
  std::array<std::int32_t, 3> count_{};
  std::vector<std::vector<Entry>> cells_;
  std::vector<std::uint8_t> is_watched_;  // of cells; others stay empty
};

}  // namespace periost
