#pragma once
// `method: paper`: sections 4.2 to 4.4 of the paper to the letter. Its guarantees are the paper's, on the
// simplex mesh: every vertex and face centre within `distance` of the isosurface, every barycentric
// coordinate at least `min_barycentric` (each unless the marching-cubes mesh missed it there from the start,
// and then no worse). The triangulation between those points is not bounded: `certified` is for that.
#include "pipeline/geometry/simplex_contour.h"
#include "stages/decimate/decimate.h"

namespace periost {

// Decimates `model`, the dual of the isosurface with its contours closed, in place and leaves dead elements
// in it; fills the report's counters and sets dual_position to the face centres, on contours
// (contour_model.h) to the middle of the contour's edge. `start` marks vertices: only edges that end in one
// are unprocessed at first, and only components that have one are decimated; empty stands for all vertices of
// all components that are not tiny. Fixed contours keep every vertex, place and border point. Components are
// independent and run in parallel; the result depends on the options and `seed` only. Precondition: no dead
// elements. Takes 10 to 20 microseconds for each vertex moved (Q^s: 12 for rigidity 1, about 40 for 3), a few
// moves for each triangle.
void decimate_paper(const Isosurface& isosurface, const DecimateOptions& options, double distance_mm,
                    std::uint64_t seed, const std::vector<std::uint8_t>& start, ContouredMesh& model,
                    Context& context);

// Adds the counts of moves and refusals of a part to those of the whole.
void add_counts(DecimationReport& sum, const DecimationReport& part);

}  // namespace periost
