#pragma once
// How the certified scheme cuts an isosurface for one phase after another: slabs, ranges of cells along one
// axis of the image.
#include <cstdint>
#include <vector>

#include "pipeline/geometry/isosurface_cut.h"

namespace periost {

struct Slab {
  std::int32_t first = 0, last = 0;  // cells first .. last - 1; the outermost are -1 and dims - 1
};

// Slabs of one list do not overlap and ascend.
struct SlabPlan {
  CutPlanes planes;           // between pieces
  std::vector<Slab> pieces;   // all cells, in parts of about as many triangles
  std::vector<Slab> shifted;  // all cells again; where pieces meet is in the middle of one
  std::vector<Slab> bands;    // narrow ones about where `shifted` meet, up to the planes at most
  std::vector<Slab> seams;    // narrow ones about those planes that a band comes up to
};

// A function of the isosurface alone. Fewer pieces where the image has too few planes. O(triangles).
// Precondition: pieces > 0.
SlabPlan plan_slabs(const Isosurface& isosurface, std::uint32_t pieces);

// The part of the isosurface in a slab, as cut_part gives it.
Isosurface cut_slab(const Isosurface& isosurface, int axis, Slab slab);

// The isosurface's numbers of that part's triangles, ascending.
std::vector<Index> triangles_of_slab(const Isosurface& isosurface, int axis, Slab slab);

}  // namespace periost
