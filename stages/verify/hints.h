#pragma once
// What failed gates ask of the next round. A table (hints.cpp) says for each metric whether its cause lies at
// places or everywhere, and whose choice it is:
//   - Angles and radius ratio of triangles: `refine` of decimate, shorter edges around the bad triangles.
//   - Shape of tetrahedra on the surface or one edge away from it: the same around the bad tetrahedra. They
//     are slender because the wall or the gap is thinner than the surface's edges are long.
//   - Shape of tetrahedra further inside: `sizes` of tetgen, smaller ones there.
//   - Distance to the isosurface: `distance` of decimate, by limit over value.
//   - Volume change, mechanics against the reference: `distance` of decimate, by a fixed share.
// Other gates (topology, counts, patch test, medians) give none: no parameter mends them.
#include "pipeline/data/hints.h"
#include "stages/verify/verify.h"

namespace periost {

// The hints given, and behind them those of the failed gates of `report`, which `verify` made of `inputs`;
// a note on the round is added. Places: balls around the elements beyond the gate's limit, of twice the
// element's longest edge; edges in it are to be 0.6 times that, or 0.6 times what an earlier hint asked for
// there in vain, and no shorter than half a voxel. Balls that an earlier hint covers with as short edges are
// left out, so hints come to an end. At most 500 places a gate, worst first. Factors multiply those given.
// Without a decimated model, places at the surface go to tetgen, and there is no hint on distances.
// Deterministic. O(elements + bad elements times places).
Hints make_hints(const QualityReport& report, const VerifyInputs& inputs);

// The distance that decimate was configured with, whatever hints made of it since: what a mesh is judged by.
double configured_distance_mm(const SimplexMesh& mesh, const Hints* hints);

}  // namespace periost
