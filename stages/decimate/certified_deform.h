#pragma once
// The law of motion (paper, equation (1); law_of_motion.h) on the certified mesh. Simplex vertices are the
// barycentres of the dual triangles, and a face moves as its vertices do on average, so a step gives every
// dual vertex a place to go to. Whether it goes there is for the checks of a relocation to say: rigidity and
// stiffness steer the surface within what is proved.
#include <vector>

#include "stages/decimate/certified_moves.h"
#include "stages/decimate/decimate.h"

namespace periost {

// Where one step of the law of motion would take each dual vertex, from where all of them are now; mm. Dead
// ones keep their place. `previous`: places before the last step, for the inertia; empty for the first. Reads
// the whole mesh and changes nothing. Deterministic for any number of threads. O(triangles * |Q^s|).
std::vector<Vec3> deformed_places(const CertifiedState& state, const DecimateOptions& options,
                                  const std::vector<Vec3>& previous, const Context& context);

// Moves the vertices to their places, or half the way; those that the checks refuse stay.
void deformation_pass(CertifiedState& state, Worker& worker, const std::vector<Index>& vertices,
                      const std::vector<Vec3>& places);

}  // namespace periost
