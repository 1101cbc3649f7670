#pragma once
// Where a dual vertex goes: the minimum of the squared distances to the isosurface's tangent planes, with a
// regularisation that acts along the surface only (Garland and Heckbert 1997; Periost's algorithm notes,
// section 5 rule 1). This is the external energy of the deformable model.
#include <vector>

#include "stages/decimate/certificate_reference.h"

namespace periost {

// q(x) = x'Ax + 2b'x + c, area-weighted squared distances to planes. Coordinates are relative to the
// reference's first point, so that digits are not lost to a far origin.
struct Quadric {
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
  Vec3 b;
  double c = 0;

  void add_plane(Vec3 normal, Vec3 point, double weight);
  Quadric& operator+=(const Quadric& other);
  double trace() const { return xx + yy + zz; }
  Vec3 times(Vec3 v) const {
    return {xx * v.x + xy * v.y + xz * v.z, xy * v.x + yy * v.y + yz * v.z, xz * v.x + yz * v.y + zz * v.z};
  }
  double at(Vec3 x) const { return dot(x, times(x)) + 2 * dot(b, x) + c; }
};

// One quadric per isosurface vertex: the planes of its triangles, each with a third of its area.
std::vector<Quadric> make_quadrics(const Reference& reference);

// Minimum of q(x) + strength * trace * |P(x - towards)|^2, P the projection along `normal`. `towards` and
// `normal` regularise along the surface; with a singular system the result is `towards`.
Vec3 best_place(const Quadric& quadric, Vec3 towards, Vec3 normal, double strength);

}  // namespace periost
