#pragma once
// The measure that `improve` raises: the smallest signed sine of a tetrahedron's six dihedral angles. It is
// small for angles near 0 and near 180 degrees alike, and negative for an inverted tetrahedron.
// At the edge between two faces sin = 6 V l / (N1 N2), with l the edge's length and N twice the areas.
// Needles and splinters may have good angles and yet a poor shape, so two more numbers count like sines, both
// 1 for the regular tetrahedron before their factor: kCompact times 6 sqrt(2) V / l_rms^3 keeps the radius
// ratio low, and kJacobian times Verdict's scaled Jacobian, 6 sqrt(2) V over the largest product of the three
// edges at a corner, keeps that up. At a target of 30 deg they decide where they are below an eighth and a
// tenth.
#include <vector>

#include "pipeline/data/vec.h"

namespace periost {

inline constexpr double kCompact = 4;
inline constexpr double kJacobian = 5;

// A tetrahedron (a, b, c, p) seen from its movable corner p: what does not change as p moves, computed once.
// Positive volume: p lies where the normal of a, b, c points to.
struct TetFan {
  TetFan() = default;
  TetFan(Vec3 a_, Vec3 b_, Vec3 c_);

  Vec3 a, b, c;
  Vec3 normal;                    // (b - a) x (c - a)
  double base = 0;                // |normal|^2
  double ab = 0, bc = 0, ca = 0;  // squared lengths
};

// The measure of (a, b, c, p), -1..1; 0 for a degenerate one. Largest for the regular tetrahedron: 0.9428.
// About 20 ns.
double smallest_sine(const TetFan& fan, Vec3 p);
inline double smallest_sine(Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
  return smallest_sine(TetFan(a, b, c), d);
}

// The six sines at p, of the edges ab, bc, ca, ap, bp, cp, and the two numbers above, with their gradients
// with respect to p.
// Precondition: no face is degenerate.
struct SineGradient {
  double sine = 0;
  Vec3 gradient;  // per mm
};
void sines_with_gradients(const TetFan& fan, Vec3 p, SineGradient (&result)[8]);

// Smallest over the fans, or any value not above `floor` as soon as one does not exceed it.
double smallest_sine(const std::vector<TetFan>& fans, Vec3 p, double floor = -2);

// The point of the convex hull of `points` nearest to the origin: along it all of them grow alike.
// Precondition: not empty.
Vec3 nearest_to_origin(const std::vector<Vec3>& points);

// Climbs from p, whose smallest sine is `sine`, along the common direction of growth of the sines that are
// within 0.03 of the smallest, with backtracking, until nothing is gained or `target` is reached. Returns the
// place; `sine` becomes its smallest sine, never less than before. With a unit `normal` the point stays in
// the plane through p across it.
Vec3 climb(const std::vector<TetFan>& fans, Vec3 p, double target, double& sine, Vec3 normal = {});

}  // namespace periost
