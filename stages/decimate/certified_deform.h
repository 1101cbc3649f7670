#pragma once
// The law of motion (paper, equation (1); law_of_motion.h) on the certified mesh. Simplex vertices are the
// barycentres of the dual triangles, and a face moves as its vertices do on average, so a step gives every
// dual vertex a place to go to. Whether it goes there is for the checks of a relocation to say: rigidity and
// stiffness steer the surface within what is proved.
#include <vector>

#include "stages/decimate/certified_moves.h"
#include "stages/decimate/decimate.h"

namespace periost {

// What some steps leave to the next; empty before the first.
struct Motion {
  std::vector<Vec3> previous;  // of dual vertices: the places before the last steps, for the inertia
  int steps = 1;               // how many steps those were
  std::vector<Index>
      near;  // of triangles: the isosurface triangle whose plane pulls, found in the first step
};

// Where some steps of the law of motion would take each dual vertex, from where all of them are now; mm. Dead
// ones keep their place. `state` is left as it was. Precondition: since the first step vertices have moved
// only. Deterministic for any number of threads. O(steps * triangles * |Q^s|).
std::vector<Vec3> deformed_places(CertifiedState& state, const DecimateOptions& options, int steps,
                                  Motion& motion, const Context& context);

// Moves the vertices to their places, or half the way; those that the checks refuse stay.
void deformation_pass(CertifiedState& state, Worker& worker, const std::vector<Index>& vertices,
                      const std::vector<Vec3>& places);

}  // namespace periost
