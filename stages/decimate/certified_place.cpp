#include "stages/decimate/certified_place.h"

#include <cmath>

namespace periost {

void Quadric::add_plane(Vec3 n, Vec3 point, double weight) {
  const double d = -dot(n, point);
  xx += weight * n.x * n.x;
  xy += weight * n.x * n.y;
  xz += weight * n.x * n.z;
  yy += weight * n.y * n.y;
  yz += weight * n.y * n.z;
  zz += weight * n.z * n.z;
  b += n * (weight * d);
  c += weight * d * d;
}

Quadric& Quadric::operator+=(const Quadric& o) {
  xx += o.xx;
  xy += o.xy;
  xz += o.xz;
  yy += o.yy;
  yz += o.yz;
  zz += o.zz;
  b += o.b;
  c += o.c;
  return *this;
}

std::vector<Quadric> make_quadrics(const Reference& reference) {
  std::vector<Quadric> quadrics(reference.points.size());
  for (Index t = 0; t < reference.triangles.size(); ++t) {
    const auto c = reference.corners(t);
    const double area = norm(cross(c[1] - c[0], c[2] - c[0])) / 2;
    Quadric plane;
    plane.add_plane(reference.normals[t], c[0] - reference.points[0], area / 3);
    for (const Index v : reference.triangles[t].corner) quadrics[v] += plane;
  }
  return quadrics;
}

Vec3 best_place(const Quadric& q, Vec3 towards, Vec3 n, double strength) {
  // (A + s(I - nn')) (x - towards) = -(A towards + b); the tiny isotropic part keeps it solvable.
  const double s = strength * q.trace(), tiny = 1e-9 * q.trace();
  const double xx = q.xx + s * (1 - n.x * n.x) + tiny, yy = q.yy + s * (1 - n.y * n.y) + tiny,
               zz = q.zz + s * (1 - n.z * n.z) + tiny;
  const double xy = q.xy - s * n.x * n.y, xz = q.xz - s * n.x * n.z, yz = q.yz - s * n.y * n.z;
  const Vec3 r = -(q.times(towards) + q.b);
  const Vec3 c0{xx, xy, xz}, c1{xy, yy, yz}, c2{xz, yz, zz};
  const double det = dot(c0, cross(c1, c2));
  if (!(det > 0) || !std::isfinite(det)) return towards;
  return towards + Vec3{dot(r, cross(c1, c2)), dot(c0, cross(r, c2)), dot(c0, cross(c1, r))} / det;
}

}  // namespace periost
