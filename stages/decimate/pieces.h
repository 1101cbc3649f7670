#pragma once
// Decimation of large isosurfaces by pieces (paper, section 4.5): the isosurface is cut along parallel planes
// of its image, every piece is decimated by itself with the contours of the cuts fixed, the pieces are sewn,
// and then edges near the seams are removed and swapped, and the mesh smoothed there, by the same rules.
#include "pipeline/geometry/isosurface_cut.h"
#include "pipeline/geometry/simplex_contour.h"
#include "stages/decimate/decimate.h"

namespace periost {

// A decimated piece, compact, its contours closed, its report filled in.
struct Piece {
  ContouredMesh model;
  std::vector<std::uint8_t> was_decimated;  // of vertices: not in a component that is tiny in the piece
};

// Piece `number` of a cut. Pieces are independent: a function of the arguments, whichever is made first.
Piece decimate_piece(const Isosurface& isosurface, const CutPlanes& planes, std::size_t number,
                     const DecimateOptions& options, double distance_mm, std::uint64_t seed,
                     const Context& context);

// Sews the pieces of a cut and decimates along the seams: edges within a few vertices of them are unprocessed
// at first, and what these moves unlabel. Contour vertices of the cuts vanish in pairs, which leaves one
// manifold mesh with the isosurface's components and Euler number. Components that are tiny as a whole stay
// as they are or are dropped, as the options ask. Precondition: all pieces of the cut, in their order.
SimplexMesh join_pieces(const Isosurface& isosurface, std::vector<Piece> pieces,
                        const DecimateOptions& options, double distance_mm, std::uint64_t seed,
                        Context& context);

// Both, pieces in parallel, along choose_cut's planes. The report counts both phases. Bits depend on the
// number of pieces, not on threads.
SimplexMesh decimate_in_pieces(const Isosurface& isosurface, std::uint32_t pieces,
                               const DecimateOptions& options, double distance_mm, std::uint64_t seed,
                               Context& context);

}  // namespace periost
