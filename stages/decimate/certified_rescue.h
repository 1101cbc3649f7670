#pragma once
// The last resort for triangles far under the least angle, which no single move can mend: many moves in a
// patch around one taken together, or taken back together (certified_patch.h).
//
// A bad triangle stays because each move that would mend it leaves one certificate or another without a
// proof: there the isosurface uses up the tolerance. Splitting an edge at its middle leaves the surface where
// it is, so it is proved whatever the tolerance; the shorter triangles then follow the isosurface closely and
// every certificate has room again. So the patch is refined by splits, whatever the angles; laid onto the
// isosurface and evened out; mended with a higher aim than the least angle, which removes most of what was
// inserted; and thinned out under the angle criterion. The result is kept if it is better. How short the
// edges and how high the aim must be differs from place to place, so a few recipes are tried in a fixed
// order; what lacks little is tried with hardly any splits first, which spares triangles. Every single move
// passes all checks but those on angles, topology and barycentric coordinates, so the invariants of
// certified.h hold throughout.
#include "pipeline/base/context.h"
#include "stages/decimate/certified_passes.h"

namespace periost {

// The living triangles with an angle under `limit`, radians, the worst first.
std::vector<Index> find_slivers(const CertifiedState& state, double limit);

// Tries to mend these: each recipe on all that are left, the worst first, but no more than `recipes` times in
// all; each takes some 50 to 300 ms. A patch is changed only if its smallest angle is greater and the sum of
// the fourth powers of its deficits to worker.limits.min_angle less than before. Needs ids in worker.dead_*;
// free vertices anywhere may move. Deterministic. Throws Error{kInterrupted}.
void rescue_slivers(CertifiedState& state, Worker& worker, double limit, std::size_t recipes,
                    const Context& context);

// Rescues the triangles with an angle under 3/4 of worker.limits.min_angle, then on a surface of less than
// 20,000 triangles those under nearly all of it, each with as many recipes as suit the number of triangles.
// Costs nothing but a look at each triangle where there are none.
void rescue_pass(CertifiedState& state, Worker& worker, const Context& context);

}  // namespace periost
