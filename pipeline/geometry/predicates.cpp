#include "pipeline/geometry/predicates.h"

#include <algorithm>
#include <cmath>

namespace periost {
namespace {

// Unit round-off is 2^-53. The determinants below are computed with relative errors of at most 4 and 8
// round-offs of the sum of the products' magnitudes (Shewchuk 1997, section 4), rounded up here.
constexpr double kFilter2d = 5e-16;
constexpr double kFilter3d = 1e-15;

int sign_of(double value) {
  return value > 0 ? 1 : value < 0 ? -1 : 0;
}

// A number as an unevaluated sum of two doubles, value and rounding error.
struct Pair {
  double high, low;
};

Pair exact_sum(double a, double b) {
  const double sum = a + b;
  const double from_b = sum - a;
  return {sum, (a - (sum - from_b)) + (b - from_b)};
}

Pair exact_difference(double a, double b) {
  return exact_sum(a, -b);
}

Pair exact_product(double a, double b) {
  const double product = a * b;
  return {product, std::fma(a, b, -product)};
}

// A sum of doubles that do not overlap, smallest first: its sign is that of the last one.
class Expansion {
 public:
  void add(double value) {
    int kept = 0;
    for (int i = 0; i < count_; ++i) {
      const Pair sum = exact_sum(value, term_[static_cast<std::size_t>(i)]);
      value = sum.high;
      if (sum.low != 0) term_[static_cast<std::size_t>(kept++)] = sum.low;
    }
    if (value != 0) term_[static_cast<std::size_t>(kept++)] = value;
    count_ = kept;
  }

  void add_product(double a, double b) {
    if (a == 0 || b == 0) return;
    const Pair product = exact_product(a, b);
    add(product.low);
    add(product.high);
  }

  void add_product(double a, double b, double c) {
    if (a == 0 || b == 0 || c == 0) return;
    const Pair product = exact_product(a, b);
    add_product(product.low, c);
    add_product(product.high, c);
  }

  int sign() const { return count_ == 0 ? 0 : sign_of(term_[static_cast<std::size_t>(count_ - 1)]); }

 private:
  // At most 6 determinant terms of 8 triple products of 4 doubles each.
  std::array<double, 200> term_;
  int count_ = 0;
};

int orient2d_exact(Vec2 a, Vec2 b, Vec2 c) {
  const Pair bx = exact_difference(b.x, a.x), by = exact_difference(b.y, a.y);
  const Pair cx = exact_difference(c.x, a.x), cy = exact_difference(c.y, a.y);
  Expansion determinant;
  const auto add = [&determinant](Pair p, Pair q, double sign) {
    for (const double r : {p.low, p.high}) {
      for (const double s : {q.low, q.high}) determinant.add_product(sign * r, s);
    }
  };
  add(bx, cy, 1);
  add(by, cx, -1);
  return determinant.sign();
}

int orient3d_exact(Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
  std::array<Pair, 3> row[3];
  const Vec3* corner[3] = {&b, &c, &d};
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t k = 0; k < 3; ++k) row[r][k] = exact_difference((*corner[r])[k], a[k]);
  }
  struct Term {
    std::size_t i, j, k;
    double sign;
  };
  constexpr Term kTerms[6] = {{0, 1, 2, 1},  {1, 2, 0, 1},  {2, 0, 1, 1},
                              {0, 2, 1, -1}, {1, 0, 2, -1}, {2, 1, 0, -1}};
  Expansion determinant;
  for (const Term& term : kTerms) {
    const Pair p = row[0][term.i], q = row[1][term.j], s = row[2][term.k];
    for (const double u : {p.low, p.high}) {
      for (const double v : {q.low, q.high}) {
        for (const double w : {s.low, s.high}) determinant.add_product(term.sign * u, v, w);
      }
    }
  }
  return determinant.sign();
}

// The point without coordinate `axis`, so that a plane that is not parallel to the axis keeps its shape.
Vec2 drop(Vec3 p, int axis) {
  return axis == 0 ? Vec2{p.y, p.z} : axis == 1 ? Vec2{p.z, p.x} : Vec2{p.x, p.y};
}

int orient_dropped(Vec3 a, Vec3 b, Vec3 c, int axis) {
  return orient2d(drop(a, axis), drop(b, axis), drop(c, axis));
}

// An axis along which a, b, c project to a proper triangle, or -1 when they lie on one line.
int projection_axis(Vec3 a, Vec3 b, Vec3 c) {
  const Vec3 normal = cross(b - a, c - a);
  std::array<int, 3> axes{0, 1, 2};
  std::sort(axes.begin(), axes.end(), [&normal](int i, int j) {
    const double u = std::abs(normal[static_cast<std::size_t>(i)]);
    const double v = std::abs(normal[static_cast<std::size_t>(j)]);
    return u != v ? u > v : i < j;
  });
  for (const int axis : axes) {
    if (orient_dropped(a, b, c, axis) != 0) return axis;
  }
  return -1;
}

// For points on one line: whether x lies between p and q, ends included.
bool is_between(Vec3 p, Vec3 q, Vec3 x) {
  for (std::size_t k = 0; k < 3; ++k) {
    if (x[k] < std::min(p[k], q[k]) || x[k] > std::max(p[k], q[k])) return false;
  }
  return true;
}

bool segments_meet_dropped(Vec3 p, Vec3 q, Vec3 r, Vec3 s, int axis) {
  const int pr = orient_dropped(p, q, r, axis), ps = orient_dropped(p, q, s, axis);
  const int rp = orient_dropped(r, s, p, axis), rq = orient_dropped(r, s, q, axis);
  if (pr * ps < 0 && rp * rq < 0) return true;
  return (pr == 0 && is_between(p, q, r)) || (ps == 0 && is_between(p, q, s)) ||
         (rp == 0 && is_between(r, s, p)) || (rq == 0 && is_between(r, s, q));
}

bool segments_meet(Vec3 p, Vec3 q, Vec3 r, Vec3 s) {
  if (orient3d(p, q, r, s) != 0) return false;
  int axis = -1;
  for (const auto& [a, b, c] : {TriangleCorners{p, q, r}, TriangleCorners{p, q, s}, TriangleCorners{p, r, s},
                                TriangleCorners{q, r, s}}) {
    axis = projection_axis(a, b, c);
    if (axis >= 0) return segments_meet_dropped(p, q, r, s, axis);
  }
  return is_between(p, q, r) || is_between(p, q, s) || is_between(r, s, p) || is_between(r, s, q);
}

bool segment_meets_coplanar_triangle(Vec3 p, Vec3 q, const TriangleCorners& t, int axis) {
  // Either an end lies inside, or the segment meets an edge.
  const int turn = orient_dropped(t[0], t[1], t[2], axis);
  if (turn * orient_dropped(t[0], t[1], p, axis) >= 0 && turn * orient_dropped(t[1], t[2], p, axis) >= 0 &&
      turn * orient_dropped(t[2], t[0], p, axis) >= 0) {
    return true;
  }
  return segments_meet_dropped(p, q, t[0], t[1], axis) || segments_meet_dropped(p, q, t[1], t[2], axis) ||
         segments_meet_dropped(p, q, t[2], t[0], axis);
}

bool edges_meet_triangle(const TriangleCorners& a, const TriangleCorners& b) {
  return segment_meets_triangle(a[0], a[1], b) || segment_meets_triangle(a[1], a[2], b) ||
         segment_meets_triangle(a[2], a[0], b);
}

// All corners of `other` lie strictly on one side of the plane of `triangle`.
bool is_separated_by_plane(const TriangleCorners& triangle, const TriangleCorners& other) {
  const int side = orient3d(triangle[0], triangle[1], triangle[2], other[0]);
  return side != 0 && orient3d(triangle[0], triangle[1], triangle[2], other[1]) == side &&
         orient3d(triangle[0], triangle[1], triangle[2], other[2]) == side;
}

TriangleCorners corners_of(const std::vector<Vec3>& points, const Triangle& t) {
  return {points[t[0]], points[t[1]], points[t[2]]};
}

// Two triangles on one edge u v, with the opposite corners p and q: folded onto each other?
bool is_folded(Vec3 u, Vec3 v, Vec3 p, Vec3 q) {
  if (orient3d(u, v, p, q) != 0) return false;
  const int axis = projection_axis(u, v, p);
  return axis >= 0 && orient_dropped(u, v, p, axis) * orient_dropped(u, v, q, axis) > 0;
}

// orient2d(a, b, p) for p moved by an infinitesimal (e, e^2): never 0 unless a equals b.
int orient2d_perturbed(Vec2 a, Vec2 b, Vec2 p) {
  const int turn = orient2d(a, b, p);
  if (turn != 0) return turn;
  return a.y != b.y ? sign_of(a.y - b.y) : sign_of(b.x - a.x);
}

}  // namespace

int orient2d(Vec2 a, Vec2 b, Vec2 c) {
  const double left = (b.x - a.x) * (c.y - a.y);
  const double right = (b.y - a.y) * (c.x - a.x);
  const double determinant = left - right;
  const double bound = kFilter2d * (std::abs(left) + std::abs(right));
  if (bound == 0 || std::abs(determinant) > bound) return sign_of(determinant);
  return orient2d_exact(a, b, c);
}

int orient3d(Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
  const Vec3 u = b - a, v = c - a, w = d - a;
  const double xy = u.x * v.y, yx = u.y * v.x;
  const double yz = u.y * v.z, zy = u.z * v.y;
  const double zx = u.z * v.x, xz = u.x * v.z;
  const double determinant = w.x * (yz - zy) + w.y * (zx - xz) + w.z * (xy - yx);
  const double permanent = std::abs(w.x) * (std::abs(yz) + std::abs(zy)) +
                           std::abs(w.y) * (std::abs(zx) + std::abs(xz)) +
                           std::abs(w.z) * (std::abs(xy) + std::abs(yx));
  // A permanent of zero means that every product has a factor that is exactly zero.
  if (permanent == 0 || std::abs(determinant) > kFilter3d * permanent) return sign_of(determinant);
  return orient3d_exact(a, b, c, d);
}

bool is_degenerate(const TriangleCorners& t) {
  return projection_axis(t[0], t[1], t[2]) < 0;
}

bool segment_meets_triangle(Vec3 p, Vec3 q, const TriangleCorners& t) {
  const int side_p = orient3d(t[0], t[1], t[2], p);
  const int side_q = orient3d(t[0], t[1], t[2], q);
  if (side_p * side_q > 0) return false;
  if (side_p == 0 && side_q == 0) {
    const int axis = projection_axis(t[0], t[1], t[2]);
    if (axis >= 0) return segment_meets_coplanar_triangle(p, q, t, axis);
    return segments_meet(p, q, t[0], t[1]) || segments_meet(p, q, t[1], t[2]) ||
           segments_meet(p, q, t[2], t[0]);
  }
  // The line p q passes all three edges on the same side, or through an edge or corner.
  const int s0 = orient3d(p, q, t[0], t[1]);
  const int s1 = orient3d(p, q, t[1], t[2]);
  if (s0 * s1 < 0) return false;
  const int s2 = orient3d(p, q, t[2], t[0]);
  return s0 * s2 >= 0 && s1 * s2 >= 0;
}

bool triangles_meet(const TriangleCorners& a, const TriangleCorners& b) {
  if (is_separated_by_plane(a, b) || is_separated_by_plane(b, a)) return false;
  return edges_meet_triangle(a, b) || edges_meet_triangle(b, a);
}

bool triangles_intersect(const std::vector<Vec3>& points, const Triangle& a, const Triangle& b) {
  std::array<std::size_t, 3> shared_a{}, shared_b{};
  std::size_t shared = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      if (a[i] != b[j]) continue;
      shared_a[shared] = i;
      shared_b[shared] = j;
      ++shared;
    }
  }
  if (shared == 0) return triangles_meet(corners_of(points, a), corners_of(points, b));
  if (shared == 1) {
    // What they have in common is convex and holds the shared corner; more of it would reach the edge
    // opposite that corner in one of them.
    const std::size_t i = shared_a[0], j = shared_b[0];
    return segment_meets_triangle(points[a[(i + 1) % 3]], points[a[(i + 2) % 3]], corners_of(points, b)) ||
           segment_meets_triangle(points[b[(j + 1) % 3]], points[b[(j + 2) % 3]], corners_of(points, a));
  }
  if (shared > 2) return true;
  const std::size_t opposite_a = 3 - shared_a[0] - shared_a[1];
  const std::size_t opposite_b = 3 - shared_b[0] - shared_b[1];
  return is_folded(points[a[shared_a[0]]], points[a[shared_a[1]]], points[a[opposite_a]],
                   points[b[opposite_b]]);
}

bool ray_crosses(const TriangleCorners& t, Vec3 p) {
  if (std::max({t[0].x, t[1].x, t[2].x}) < p.x) return false;
  const Vec2 a{t[0].y, t[0].z}, b{t[1].y, t[1].z}, c{t[2].y, t[2].z}, q{p.y, p.z};
  if (std::max({a.x, b.x, c.x}) < q.x || std::min({a.x, b.x, c.x}) > q.x || std::max({a.y, b.y, c.y}) < q.y ||
      std::min({a.y, b.y, c.y}) > q.y) {
    return false;
  }
  const int turn = orient2d(a, b, c);
  if (turn == 0 || orient2d_perturbed(a, b, q) != turn || orient2d_perturbed(b, c, q) != turn ||
      orient2d_perturbed(c, a, q) != turn) {
    return false;
  }
  // Counter-clockwise in (y, z) means a normal with positive x: the ray crosses when p is behind the plane.
  return orient3d(t[0], t[1], t[2], p) * turn < 0;
}

bool is_inside_by_parity(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles,
                         Vec3 point) {
  bool is_inside = false;
  for (const Triangle& triangle : triangles) {
    if (ray_crosses(corners_of(points, triangle), point)) is_inside = !is_inside;
  }
  return is_inside;
}

}  // namespace periost
