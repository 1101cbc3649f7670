#pragma once
// The local criteria that a proposal must meet before the costly certificates are tried: triangle angles,
// topology, barycentric coordinates, fold, dihedral angles (Delingette 1997 section 4.1; Periost's algorithm
// notes, section 4).
//
// Violations that were there before, as marching cubes makes them, are dealt with by one rule: the sum of
// deficits over the triangles concerned, removed ones included, must not grow. Where there were none, none
// may arise.
#include "stages/decimate/certified_mesh.h"

namespace periost {

// Why a proposal was refused, by the criterion that refused first.
enum class Refusal : std::uint8_t {
  kNone,
  kLink,
  kTopology,
  kBarycentric,
  kAngle,
  kFold,
  kDistance,
  kReverse,
  kSelfIntersection,
  kSize,
  kCount
};

struct GuardLimits {
  double min_angle = 0.5235987755982988;  // of dual triangles, radians
  double min_barycentric = 0.1;           // of simplex vertices among their neighbours
  int topology = 3;                       // T: largest |D| of an edge
  int min_valence = 4;                    // one vertex inside a triangle halves its angles
  int max_valence = 9;
  double fold_cosine = 0.4;        // least product of a new normal with the isosurface's or the old one
  double dihedral_cosine = -0.94;  // least product of the normals over an edge: angles of 20 degrees and more
  // While min_angle is only aimed for: the limit itself, radians, to which the sum of deficits must not grow
  // either. Else 0.
  double floor_angle = 0;
  // Deficits of angles count by their fourth power, so that the worst angle may rise at the cost of better
  // ones.
  bool worst_angle_first = false;
  double growth = 0;  // part of the sum of deficits by which it may grow
};

// The limits with another least angle. One above theirs is only aimed for.
inline GuardLimits aiming_at(GuardLimits limits, double angle) {
  limits.floor_angle = angle > limits.min_angle ? limits.min_angle : 0;
  limits.min_angle = angle;
  return limits;
}

// Smallest angle of a triangle, radians; 0 when degenerate.
double min_angle(const std::array<Vec3, 3>& triangle);

// Twice the cosine of the smallest angle, which orders triangles as the angle does and costs less; 2 when
// degenerate.
double twice_largest_cosine(const std::array<Vec3, 3>& triangle);
// Whether the smallest angle is under the limit, radians.
bool has_angle_under(const std::array<Vec3, 3>& triangle, double limit);

// Valences and, unless `only_valences`, the topological criterion.
bool meets_topology(const CertifiedMesh& mesh, const Proposal& proposal, const GuardLimits& limits,
                    bool only_valences = false);

// Angles of the dual triangles. `gain`, when given, receives the fall of the sum of deficits, radians, where
// they are met. The limits are the same from a proposal's beginning on.
bool meets_angles(const CertifiedMesh& mesh, Proposal& proposal, const GuardLimits& limits,
                  double* gain = nullptr);

// Fold against the isosurface's normals, and dihedral angles inside and at the rim of the ring.
bool meets_fold(const Reference& reference, const CertifiedMesh& mesh, const Proposal& proposal,
                const GuardLimits& limits);

// Barycentric coordinates of the simplex vertices (barycentres of the dual triangles) in the triangles of
// their neighbours, in the ring and just around it.
bool meets_barycentric(const CertifiedMesh& mesh, const Proposal& proposal, const GuardLimits& limits);

// The smallest barycentric coordinate of the foot of p in the triangle a, b, c.
double smallest_barycentric(Vec3 p, Vec3 a, Vec3 b, Vec3 c);

}  // namespace periost
