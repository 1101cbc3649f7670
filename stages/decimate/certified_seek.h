#pragma once
// Searches for a place of a merged or moved dual vertex where the angles of its ring hold.
#include "stages/decimate/certified_guard.h"
#include "stages/decimate/certified_place.h"

namespace periost {

// Moves proposal.place along the surface (perpendicular to `normal`, unit) until every angle of the ring
// reaches limits.min_angle: steps that would mend the worst angle were it linear, one after the other, at
// most twelve; then to the height where `quadric` (relative to `origin`) is least. False when some angle
// stays under the limit; the place is then of no use. Precondition: the proposal moves a vertex, which is
// corner 0 of each of its cells or belongs to each.
bool seek_angles(const CertifiedMesh& mesh, const GuardLimits& limits, const Quadric& quadric, Vec3 origin,
                 Vec3 normal, Proposal& proposal);

}  // namespace periost
