#pragma once
// The law of motion one dimension down (Delingette 1994; law_of_motion.h) for the contours of the certified
// mesh: a vertex P between its contour neighbours A and B has the barycentric coordinates of its foot on AB,
// power eps_A eps_B |AB|^2, radius |AB| / 2, and the height and angle that go with them; its Q^s is the part
// of the contour within s edges on the same border plane; the isosurface's contour pulls it.
#include <vector>

#include "stages/decimate/certified_moves.h"
#include "stages/decimate/decimate.h"

namespace periost {

// Writes to `places` where one step would take each contour vertex that may move. `previous`: places before
// the last step, for the inertia; empty for the first. O(contour vertices * s).
void deform_contours(const CertifiedState& state, const DecimateOptions& options,
                     const std::vector<Vec3>& previous, std::vector<Vec3>& places);

}  // namespace periost
