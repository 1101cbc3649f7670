#include "stages/decimate/certificate_forward.h"

#include <algorithm>

namespace periost {
namespace {

constexpr int kBisectionDepth = 9;
constexpr int kWalkLimit = 256;
constexpr std::size_t kFloodLimit = 4096;
constexpr double kMinimumObliquity = 0.2;  // least product of T's normal with the direction
constexpr double kMargin = 1e-10;          // of barycentric coordinates, always on the safe side
// An interior point of T in general position; the degree is measured there.
constexpr std::array<double, 3> kProbe{0.337103, 0.328759, 0.334138};

// A point in T's coordinates: barycentric along the direction, and height in mm.
struct Shadow {
  std::array<double, 3> lambda;
  double height;
};

// The affine map from space to shadows.
class ShadowMap {
 public:
  ShadowMap(const std::array<Vec3, 3>& t, Vec3 direction) : origin_(t[0]) {
    const Vec3 e1 = t[1] - t[0], e2 = t[2] - t[0];
    const Vec3 n = cross(e1, e2);
    const double det = dot(n, direction);
    valid_ = det > kMinimumObliquity * norm(n);
    if (!valid_) return;
    row1_ = cross(e2, direction) / det;
    row2_ = cross(direction, e1) / det;
    row3_ = n / det;
  }
  bool is_valid() const { return valid_; }
  Shadow operator()(Vec3 p) const {
    const Vec3 d = p - origin_;
    const double l1 = dot(row1_, d), l2 = dot(row2_, d);
    return {{1 - l1 - l2, l1, l2}, dot(row3_, d)};
  }

 private:
  Vec3 origin_, row1_, row2_, row3_;
  bool valid_ = false;
};

// Twice the signed area of (a, b, c) in the plane of the second and third coordinate.
double turn(const std::array<double, 3>& a, const std::array<double, 3>& b, const std::array<double, 3>& c) {
  return (b[1] - a[1]) * (c[2] - a[2]) - (b[2] - a[2]) * (c[1] - a[1]);
}

// Bits of T's sides that a point lies beyond.
unsigned sides_beyond(const Shadow& p) {
  return static_cast<unsigned>(p.lambda[0] < -kMargin) | static_cast<unsigned>(p.lambda[1] < -kMargin) << 1 |
         static_cast<unsigned>(p.lambda[2] < -kMargin) << 2;
}

// Whether the shadow of an edge meets T; true in doubt.
bool edge_meets(const Shadow& a, const Shadow& b) {
  const unsigned beyond_a = sides_beyond(a), beyond_b = sides_beyond(b);
  if ((beyond_a & beyond_b) != 0) return false;
  if (beyond_a == 0 || beyond_b == 0) return true;
  double first = 0, last = 1;
  for (std::size_t i = 0; i < 3; ++i) {
    const double la = a.lambda[i] + kMargin, lb = b.lambda[i] + kMargin;
    if (la < 0) first = std::max(first, la / (la - lb));
    if (lb < 0) last = std::min(last, la / (la - lb));
  }
  return first <= last + kMargin;
}

// The overlay of T with an isosurface triangle: the corners of its shadow clipped by T's three sides
// (Sutherland and Hodgman 1974).
struct Overlay {
  std::array<Shadow, 9> corner;
  std::size_t count = 0;
};
Overlay overlay_of(const std::array<Shadow, 3>& s) {
  Overlay overlay;
  std::array<Shadow, 9> clipped;
  overlay.count = 3;
  std::copy(s.begin(), s.end(), overlay.corner.begin());
  for (std::size_t side = 0; side < 3; ++side) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < overlay.count; ++i) {
      const Shadow& a = overlay.corner[i];
      const Shadow& b = overlay.corner[i + 1 == overlay.count ? 0 : i + 1];
      const double la = a.lambda[side], lb = b.lambda[side];
      if (la >= -kMargin) clipped[kept++] = a;
      if ((la >= -kMargin) != (lb >= -kMargin)) {
        const double t = (la + kMargin) / (la - lb);
        Shadow& cut = clipped[kept++];
        for (std::size_t k = 0; k < 3; ++k) cut.lambda[k] = a.lambda[k] + t * (b.lambda[k] - a.lambda[k]);
        cut.height = a.height + t * (b.height - a.height);
      }
    }
    overlay.count = kept;
    std::copy(clipped.begin(), clipped.begin() + static_cast<std::ptrdiff_t>(kept), overlay.corner.begin());
  }
  return overlay;
}

Vec3 point_of(const std::array<Vec3, 3>& t, const Shadow& p) {
  return t[0] * p.lambda[0] + t[1] * p.lambda[1] + t[2] * p.lambda[2];
}

// Whether T is within the tolerance of the isosurface all over its overlay with the triangle `id`: by the
// heights, or because the overlay's corners are all within the tolerance of one triangle, this or one beside
// it. If not, `highest` is the corner of the overlay with the greatest height.
bool overlay_is_within(const Reference& reference, Index id, const std::array<Shadow, 3>& s,
                       const std::array<Vec3, 3>& t, double tolerance, Vec3& highest) {
  const auto is_low = [&](const Shadow& p) { return std::abs(p.height) <= tolerance; };
  if (is_low(s[0]) && is_low(s[1]) && is_low(s[2])) return true;
  const Overlay overlay = overlay_of(s);
  const auto begin = overlay.corner.begin(), end = begin + static_cast<std::ptrdiff_t>(overlay.count);
  if (std::all_of(begin, end, is_low)) return true;
  std::array<Vec3, 9> point;
  for (std::size_t i = 0; i < overlay.count; ++i) point[i] = point_of(t, overlay.corner[i]);
  const auto is_near = [&](Index other) {
    if (other == kNoIndex) return false;
    const auto corners = reference.corners(other);
    return std::all_of(point.begin(), point.begin() + static_cast<std::ptrdiff_t>(overlay.count),
                       [&](Vec3 x) { return squared_distance(x, corners) <= tolerance * tolerance; });
  };
  const auto& across = reference.triangles[id].across;
  if (is_near(id) || is_near(across[0]) || is_near(across[1]) || is_near(across[2])) return true;
  const auto top = std::max_element(
      begin, end, [](const Shadow& a, const Shadow& b) { return std::abs(a.height) < std::abs(b.height); });
  highest = point[static_cast<std::size_t>(top - begin)];
  return false;
}

// What a triangle adds to the degree at the probe: positive ones count only when surely around it, negative
// ones also when perhaps.
int degree_at_probe(const std::array<Shadow, 3>& s) {
  const double a = turn(s[0].lambda, s[1].lambda, kProbe), b = turn(s[1].lambda, s[2].lambda, kProbe),
               c = turn(s[2].lambda, s[0].lambda, kProbe);
  if (a > kMargin * kMargin && b > kMargin * kMargin && c > kMargin * kMargin) return 1;
  return a < kMargin && b < kMargin && c < kMargin ? -1 : 0;
}

std::array<Shadow, 3> shadows(const Reference& reference, Index t, const ShadowMap& map) {
  const auto c = reference.corners(t);
  return {map(c[0]), map(c[1]), map(c[2])};
}

// Walks over the isosurface to the triangle under the probe; kNoIndex when it folds back or has a contour on
// the way.
Index walk_to_probe(const Reference& reference, Index start, const ShadowMap& map) {
  Index t = start;
  for (int step = 0; step < kWalkLimit && t != kNoIndex; ++step) {
    const auto s = shadows(reference, t, map);
    double worst = 0;
    std::size_t exit = 3;
    for (std::size_t k = 0; k < 3; ++k) {
      const double side = turn(s[(k + 1) % 3].lambda, s[(k + 2) % 3].lambda, kProbe);
      if (side < worst) {
        worst = side;
        exit = k;
      }
    }
    if (exit == 3) return t;
    t = reference.triangles[t].across[exit];
  }
  return kNoIndex;
}

struct Piece {
  std::array<Vec3, 3> corner;
  std::array<std::uint32_t, 3> list;  // offset in the pool; pool[list] is the length
  int depth;
};

// Appends the triangles near a point to the pool; false when there is none.
bool push_near(const Reference& reference, Vec3 point, double tolerance, ForwardScratch& scratch,
               std::uint32_t& list) {
  reference.within(point, tolerance, scratch.found);
  list = static_cast<std::uint32_t>(scratch.pool.size());
  scratch.pool.push_back(static_cast<Index>(scratch.found.size()));
  scratch.pool.insert(scratch.pool.end(), scratch.found.begin(), scratch.found.end());
  return !scratch.found.empty();
}

bool share_a_triangle(const std::vector<Index>& pool, const std::array<std::uint32_t, 3>& list) {
  const auto contains = [&](std::uint32_t l, Index t) {
    const auto begin = pool.begin() + l + 1;
    return std::find(begin, begin + pool[l], t) != begin + pool[l];
  };
  for (std::uint32_t i = 0; i < pool[list[0]]; ++i) {
    const Index t = pool[list[0] + 1 + i];
    if (contains(list[1], t) && contains(list[2], t)) return true;
  }
  return false;
}

std::size_t longest_edge(const std::array<Vec3, 3>& c) {
  std::size_t longest = 0;
  double length = -1;
  for (std::size_t k = 0; k < 3; ++k) {
    const double l = squared_norm(c[(k + 2) % 3] - c[(k + 1) % 3]);
    if (l > length) {
      length = l;
      longest = k;
    }
  }
  return longest;
}

}  // namespace

Answer certify_by_overlay(const Reference& reference, const DualTriangle& triangle, Vec3 direction,
                          double tolerance, ForwardScratch& scratch) {
  const ShadowMap map(triangle.corner, direction);
  if (!map.is_valid()) return Answer::kUnknown;
  const Index seed = walk_to_probe(reference, triangle.nearest[0], map);
  if (seed == kNoIndex) return Answer::kUnknown;
  scratch.stamp.resize(reference.triangles.size(), 0);
  if (++scratch.tick == 0) {
    std::fill(scratch.stamp.begin(), scratch.stamp.end(), 0u);
    scratch.tick = 1;
  }
  auto& queue = scratch.queue;
  queue.assign(1, seed);
  scratch.stamp[seed] = scratch.tick;
  int degree = 0;
  for (std::size_t head = 0; head < queue.size(); ++head) {
    const auto s = shadows(reference, queue[head], map);
    Vec3 highest;
    if (!overlay_is_within(reference, queue[head], s, triangle.corner, tolerance, highest)) {
      return reference.has_within(highest, tolerance) ? Answer::kUnknown : Answer::kRefuted;
    }
    degree += degree_at_probe(s);
    for (std::size_t k = 0; k < 3; ++k) {
      const Index next = reference.triangles[queue[head]].across[k];
      if (next != kNoIndex && scratch.stamp[next] == scratch.tick) continue;
      if (!edge_meets(s[(k + 1) % 3], s[(k + 2) % 3])) continue;
      if (next == kNoIndex || queue.size() > kFloodLimit) return Answer::kUnknown;
      scratch.stamp[next] = scratch.tick;
      queue.push_back(next);
    }
  }
  return degree >= 1 ? Answer::kProved : Answer::kUnknown;
}

bool certify_by_bisection(const Reference& reference, const std::array<Vec3, 3>& triangle, double tolerance,
                          int depth, ForwardScratch& scratch) {
  scratch.pool.clear();
  Piece whole{triangle, {}, 0};
  for (std::size_t k = 0; k < 3; ++k) {
    if (!push_near(reference, triangle[k], tolerance, scratch, whole.list[k])) return false;
  }
  // Breadth first: a refutation is found on the coarsest level that shows it.
  std::vector<Piece> level{whole}, next;
  while (!level.empty()) {
    next.clear();
    for (const Piece& piece : level) {
      if (share_a_triangle(scratch.pool, piece.list)) continue;
      if (piece.depth == depth) return false;
      const std::size_t k = longest_edge(piece.corner), a = (k + 1) % 3, b = (k + 2) % 3;
      const Vec3 middle = (piece.corner[a] + piece.corner[b]) * 0.5;
      std::uint32_t list = 0;
      if (!push_near(reference, middle, tolerance, scratch, list)) return false;
      for (const std::size_t replaced : {a, b}) {
        Piece half = piece;
        half.corner[replaced] = middle;
        half.list[replaced] = list;
        ++half.depth;
        next.push_back(half);
      }
    }
    level.swap(next);
  }
  return true;
}

bool certify_forward(const Reference& reference, const DualTriangle& triangle, double tolerance,
                     ForwardScratch& scratch) {
  const auto& near = triangle.nearest;
  const Vec3 mean =
      normalized(reference.normals[near[0]] + reference.normals[near[1]] + reference.normals[near[2]]);
  const auto overlay = [&](Vec3 direction) {
    return certify_by_overlay(reference, triangle, direction, tolerance, scratch);
  };
  const Answer answer = overlay(mean);
  if (answer != Answer::kUnknown) return answer == Answer::kProved;
  // Of what the first overlay leaves open, bisection proves nine in ten, the second overlay one in six.
  const auto& c = triangle.corner;
  if (certify_by_bisection(reference, c, tolerance, kBisectionDepth, scratch)) return true;
  return overlay(normalized(cross(c[1] - c[0], c[2] - c[0]))) == Answer::kProved;
}

}  // namespace periost
