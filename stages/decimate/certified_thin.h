#pragma once
// Removals that no single move can make: an edge is removed although angles of the ring become too small, the
// patch around is mended, and all is taken back unless the angles are as good as before
// (certified_patch.h). Where nothing more can be removed this thins out a surface by some more percent.
#include "pipeline/base/context.h"
#include "stages/decimate/certified_passes.h"

namespace periost {

// Tries every edge between the vertices once. A patch is kept as it becomes only if it has fewer triangles
// and the sum of its deficits to worker.limits.min_angle has not grown; every single move passes all checks
// but those on angles and barycentric coordinates. The worker must be the only one: patches reach across
// regions. Contours stay as they are. Some 0.5 ms an edge that the certificates let go, which few do; much
// less for others. Ends when worker.quota is used up. Deterministic. Throws Error{kInterrupted}.
void thinning_pass(CertifiedState& state, Worker& worker, const VertexList& vertices, const Context& context);

}  // namespace periost
