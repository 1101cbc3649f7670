#pragma once
// The certified scheme by pieces (paper, section 4.5), for isosurfaces whose working state would not fit in
// memory as a whole. The isosurface is cut along planes of its image; every piece is decimated by itself, its
// cut contours locked; the pieces are joined by their common points; then a band around each seam is
// decimated by the same rules. The working state of one piece or band is alive at a time.
//
// Why the proofs of certified.h hold for the whole. A piece proves F against its own part of the isosurface,
// which is a part of the whole, and R for its own part; so the joined mesh has both. A band has the
// isosurface triangles of the cells around a seam with their proofs, and all output triangles that meet these
// cells' slab. F: new triangles are proved against the band's isosurface, a part of the whole. R: a move
// changes triangles of one ring of vertices that are free in the band. A vertex is free only if it lies in
// the slab and every isosurface triangle that names one of its triangles, as home or label, is in the band;
// so every proof that a move may hurt is there to be renewed. Intersections: pieces stay between their cuts,
// a free ring stays in the slab, and all that meets the slab is in the band. Contours of an open surface (C)
// are decimated in the pieces and keep their place in the bands.
//
// Bands are apart, so neither the order of pieces nor that of bands matters.
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

// Steps of decimate_certified (certified.cpp): the state that is the isosurface itself, the moves, and the
// model of the result.
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

// How far the schedule runs: through the removals in stages by cost, or altogether.
enum class Extent { kByCost, kToTheEnd };
MoveCounts run_certified_schedule(CertifiedState& state, const DecimateOptions& options, Extent extent,
                                  const Context& context);

SimplexMesh finish_certified(const SurfaceMesh& surface, const MoveCounts& counts,
                             const Isosurface& isosurface, const DecimateOptions& options,
                             const Context& context);

}  // namespace periost
