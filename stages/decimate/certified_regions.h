#pragma once
// Regions of space that are decimated at the same time. They are cut by the data alone, so the result does
// not depend on the number of threads; seams lie elsewhere in every cut, so no vertex stays on one.
#include <vector>

#include "stages/decimate/certified_moves.h"

namespace periost {

// A box of the image's index space, a little less than its planes bound, and the living vertices between
// these, in ascending order. Moves of the region keep inside the box.
struct Region {
  Vec3 lo, hi;
  std::vector<Index> vertices;
};

// Cuts space by planes between the cells of the grid of sheets until no region has more than `most` vertices
// (or none can be cut further). `turn` = 0, 1, 2.. shifts the planes. Vertices with an edge to another
// region, or on a plane, are locked; locks of the cut before end. With more than one region, the grid of
// sheets is purged, so that each of its cells holds only triangles that are there.
//
// Why regions may be worked on together. A move writes triangles of its ring and next to it, proofs homed
// there, and numbers of the ring's vertices. All these vertices are unlocked, so their neighbours, and with
// them every triangle written, belong to the region. What is read beyond are triangles and vertices at an
// edge between two of its vertices: of its own, or locked and thus the same throughout. New triangles stay in
// the box, so they are entered in its own cells of the grid, where foreign triangles are at locked vertices.
std::vector<Region> cut_regions(CertifiedState& state, std::size_t most, unsigned turn,
                                const Context& context);

}  // namespace periost
