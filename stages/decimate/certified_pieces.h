#pragma once
// The certified scheme by pieces (paper, section 4.5), for isosurfaces whose working state would not fit in
// memory as a whole. The isosurface is cut along planes of its image, and decimated in phases; the
// working state of one piece or slab is alive at a time.
// 1. Every piece by itself, its cut contours locked, through the removals in stages by cost only: pieces
//    decimated to the end would leave a dense strip at each cut between triangles that no longer yield. The
//    pieces are joined by their common points.
// 2. Slabs from the middle of one piece to the middle of the next, all to the end: each cut lies inside one.
// 3. Bands about these middles, and about cuts that such bands come up to, to the end.
//
// Why the proofs of certified.h hold for the whole. A piece proves F against its own part of the isosurface,
// which is a part of the whole, and R for its own part; so the joined mesh has both. A slab has the
// isosurface triangles of its cells with their proofs, and all output triangles that meet it. F: new
// triangles are proved against the slab's isosurface, a part of the whole. R: a move replaces triangles of
// one ring, whose vertices are all free. Free are vertices within the slab; and of a triangle that a proof of
// another slab's isosurface names, as home or label, one vertex at least is not, so that it stays. So every
// proof that a move may hurt is there to be renewed, and what proofs in the slab rest on outside of it does
// not move. Intersections: pieces stay between their cuts, a free ring stays in the slab, and all that meets
// the slab is in its mesh. Contours of an open surface (C) are decimated in the pieces, which then go to the
// end, and keep their place in slabs.
//
// Slabs of a phase do not overlap. A triangle over a border between two has vertices that are locked in both,
// so neither changes it; and which triangles stay for the sake of other slabs' proofs follows from the proofs
// before the phase. So the order of slabs does not matter, nor does that of pieces.
#include "stages/decimate/certified_moves.h"
#include "stages/decimate/decimate.h"

namespace periost {

// As decimate_certified; `pieces` > 1. Fewer where the image has too few planes. Bits depend on the number of
// pieces, not on threads, nor on the order in which pieces and slabs are taken: ascending, or as drawn with
// an `order_seed` other than 0.
SimplexMesh decimate_certified_in_pieces(const Isosurface& isosurface, std::uint32_t pieces,
                                         const DecimateOptions& options, Context& context,
                                         std::uint64_t order_seed = 0);

// The number of pieces with which decimate_certified keeps within context.memory_bytes; 1 without a budget.
// From sizes and measured bytes per triangle alone. Throws Error{kLimit, "limit.memory"} that states the
// smallest feasible budget.
std::uint32_t pieces_within(const Isosurface& isosurface, const Context& context);

// Steps of decimate_certified (certified.cpp): the state that is the isosurface itself, and the model of the
// result.
CertifiedState make_certified_state(const Reference& reference, const Isosurface& isosurface,
                                    const DecimateOptions& options, const Context& context);

// What a state is made of that is not the same for all.
struct StateParts {
  CertifiedMesh mesh;
  ReverseProofs proofs;
  std::vector<Quadric> quadrics;
  CertifiedContours contours;
};
CertifiedState assemble_state(const Reference& reference, const Isosurface& isosurface, StateParts parts,
                              const DecimateOptions& options, const Context& context);

SimplexMesh finish_certified(const SurfaceMesh& surface, const MoveCounts& counts,
                             const Isosurface& isosurface, const DecimateOptions& options,
                             const Context& context);

}  // namespace periost
