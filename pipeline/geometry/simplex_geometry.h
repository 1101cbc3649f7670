#pragma once
// The local geometry of a simplex-mesh vertex against its three neighbours (Delingette 1994, sections 3 and
// 4): metric parameters, simplex angle, and the height that realises an angle. Pure functions; invariant
// under rigid motion; angles and barycentric coordinates also under scale.
#include <array>

#include "pipeline/data/simplex_mesh.h"
#include "pipeline/data/vec.h"

namespace periost {

// A vertex P seen from the triangle of its neighbours P1, P2, P3.
struct SimplexParameters {
  std::array<double, 3>
      barycentric{};           // eps_1..3 of the foot F of P in the neighbours' triangle; they sum to 1
  Vec3 normal;                 // unit normal of that triangle, outward for counter-clockwise neighbours
  Vec3 foot;                   // F
  double height = 0;           // h, signed distance of P from the triangle's plane along `normal`
  double power = 0;            // pw = r^2 - |FC|^2, C the circumcentre; negative outside the circumcircle
  double circumradius = 0;     // r
  bool is_degenerate = false;  // the neighbours lie on a line or coincide; nothing else is meaningful
};
SimplexParameters simplex_parameters(Vec3 p, const std::array<Vec3, 3>& neighbours);
// The same for vertex v of a mesh. Precondition: v has three neighbours.
SimplexParameters simplex_parameters(const SimplexMesh& mesh, SimplexVertex v);

// The simplex angle phi in radians, (-pi, pi], positive where the surface is convex. On a sphere of radius R
// through all four points sin(phi) = r / R; on a plane phi = 0.
//   pw >= 0: atan2(2 r h, pw - h^2)        pw < 0: atan2(2 r h, |pw| + h^2)
double simplex_angle(const SimplexParameters& parameters);

// L(phi): the height above a foot of the given power at which the simplex angle is `angle`; L(phi(h)) = h for
// pw >= 0, and for pw < 0 while h^2 <= |pw| (beyond, the angle has two heights and the lower is returned).
//   pw >= 0: pw sin / (r cos + sqrt(r^2 cos^2 + pw sin^2))
//   pw <  0: |pw| sin / (r cos + sqrt(max(0, r^2 cos^2 - |pw| sin^2)))
double height_at_angle(double angle, double power, double circumradius);

}  // namespace periost
