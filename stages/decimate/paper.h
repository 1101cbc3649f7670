#pragma once
// `method: paper`: sections 4.2 to 4.4 of the paper to the letter. Its guarantees are the paper's, on the
// simplex mesh: every vertex and face centre within `distance` of the isosurface, every barycentric
// coordinate at least `min_barycentric` (each unless the marching-cubes mesh missed it there from the start,
// and then no worse). The triangulation between those points is not bounded: `certified` is for that.
#include "stages/decimate/decimate.h"

namespace periost {

// Decimates `mesh`, the dual of the isosurface, in place and leaves dead elements in it; fills the report's
// counters and sets dual_position to the face centres. Components are independent and run in parallel; the
// result depends on the options and `seed` only. Precondition: no contours. Takes 10 to 20 microseconds for
// each vertex moved (Q^s: 12 for rigidity 1, about 40 for 3), a few moves for each triangle.
void decimate_paper(const Isosurface& isosurface, const DecimateOptions& options, double distance_mm,
                    std::uint64_t seed, SimplexMesh& mesh, Context& context);

}  // namespace periost
