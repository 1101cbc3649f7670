#pragma once
// Limits on the size of the triangles that decimation makes, for what comes after it: a volume mesher needs
// small triangles where the body is thin and sizes that change slowly; a user wants more of them near a load.
#include <vector>

#include "stages/decimate/certified_mesh.h"
#include "stages/decimate/decimate.h"

namespace periost {

struct SizeLimits {
  std::vector<float> longest_edge;  // of isosurface triangles, mm: longest edge near it; empty: no limit
  double grading = 0;               // largest ratio of the longest edges of two neighbours; 0: no limit
};

// The limits that the options ask, by the centroid of each triangle of the isosurface. The thickness at a
// triangle is the distance along its normal, either way, to the next sheet that faces the other way: of the
// body, or of the gap before it. O(triangles); parallel, the same for any number of threads.
SizeLimits make_size_limits(const Isosurface& isosurface, const Reference& reference,
                            const DecimateOptions& options, const Context& context);

// Whether a proposal keeps the limits: the sum of excesses over the triangles concerned must not grow, as for
// the other criteria (certified_guard.h), so that what is too long from the start may stay.
bool meets_sizes(const SizeLimits& limits, const CertifiedMesh& mesh, const Proposal& proposal);

}  // namespace periost
