#pragma once
// Bodies made of round cones, and noise: what phantoms are modelled with. Lengths in mm in axes parallel to
// the grid, with the origin in the image's middle.
#include <cstddef>
#include <cstdint>
#include <vector>

#include "pipeline/data/vec.h"

namespace periost {

// All balls whose centres run from a to b while their radii run from radius_a to radius_b.
struct RoundCone {
  Vec3 a;
  Vec3 b;
  double radius_a = 0;
  double radius_b = 0;
};

// Depth of a point below the cone's surface, mm, positive inside; close to a distance near the surface.
double depth_in(const RoundCone& cone, Vec3 p);

// A union of round cones, its creases rounded off over `blend` mm (0: sharp).
struct Body {
  std::vector<RoundCone> cones;
  double blend = 0;
};

// Points (x0 + n * dx, y, z), n from 0.
struct Line {
  double x0 = 0;
  double dx = 1;
  double y = 0;
  double z = 0;

  Vec3 point(std::size_t n) const { return {x0 + static_cast<double>(n) * dx, y, z}; }
};

// Depths of the points of a line below the body's surface, mm, positive inside, close to a distance near the
// surface. Points deeper outside than `margin` may get any value below -margin.
void depths_on_line(const Body& body, const Line& line, double margin, std::vector<double>& depths);

// Smooth noise in -1..1 with features of size 1: lattice values joined by cubic ramps.
double smooth_noise(std::uint64_t seed, Vec3 p);

}  // namespace periost
