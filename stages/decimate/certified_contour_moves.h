#pragma once
// Moves of the certified scheme at contours (certified_contours.h). A vertex on a contour has half a disc of
// triangles. An edge of the contour is removed with the place of the merged vertex on, or beside, the
// isosurface's contour and on the border plane where the contour is; an edge between the inside and a contour
// is contracted to its end on the contour, which stays where it is; an inner edge between two vertices of
// contours is never removed. All checks of other moves apply, and the contour certificate where contour edges
// change. Pinned vertices stay; of two, none is removed.
#include <vector>

#include "stages/decimate/certified_moves.h"

namespace periost {

// Whether the edge of triangle t opposite to corner k ends on a contour.
inline bool touches_contour(const CertifiedMesh& mesh, Index t, std::size_t k) {
  if (mesh.contour.empty()) return false;
  const auto& corner = mesh.triangles[t].corner;
  return mesh.contour[corner[(k + 1) % 3]] != kOffContour || mesh.contour[corner[(k + 2) % 3]] != kOffContour;
}

// T1^2 on such an edge, without its place; false when the result would not be a simplicial manifold with the
// same contours, or when a vertex of it is locked.
bool propose_contour_removal(const CertifiedMesh& mesh, Index t, std::size_t k, Proposal& proposal);
// A vertex on a contour moves.
bool propose_contour_relocation(const CertifiedMesh& mesh, Index vertex, Proposal& proposal);

// The moves themselves, as in certified_moves.h, which hands them on to here. With `improve_angles` the sum
// of angle deficits must fall. The place of a relocation is taken onto the border plane first.
bool try_contour_removal(CertifiedState& state, Worker& worker, Index t, std::size_t k, bool improve_angles);
bool try_contour_relocation(CertifiedState& state, Worker& worker, Index vertex, Vec3 place,
                            bool improve_angles);
double contour_removal_cost(const CertifiedState& state, Index u, Index v);

// Moves contour vertices along their contours: those with an angle under `aim` (radians) at them to where the
// sum of deficits falls, others towards the middle between their neighbours along the contour.
void contour_pass(CertifiedState& state, Worker& worker, const std::vector<Index>& vertices, double aim);

}  // namespace periost
