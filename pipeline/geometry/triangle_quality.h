#pragma once
// Shape of one triangle, from its corners in any order of length unit. Metrics of Verdict keep its definition
// (Stimpson et al. 2007, sections 4). All are invariant under rigid motion, scale and renumbering.
#include "pipeline/data/vec.h"

namespace periost {

// What an unbounded metric gives for a degenerate element, as in Verdict: JSON has no infinity.
inline constexpr double kUnboundedMetric = 1e30;

// Smallest of the three angles in degrees. Range 0..60; 60 for the equilateral triangle, 0 for a degenerate
// one. Each angle is atan2(|u x v|, u . v) between the sides at its corner.
double triangle_min_angle_deg(Vec3 a, Vec3 b, Vec3 c);

// R / (2 r), circumradius over twice the inradius: l0 l1 l2 (l0 + l1 + l2) / (16 A^2). Range 1..1e30; 1 for
// the equilateral triangle, 1e30 for a degenerate one.
double triangle_radius_ratio(Vec3 a, Vec3 b, Vec3 c);

}  // namespace periost
