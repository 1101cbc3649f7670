#include "pipeline/geometry/surface_distance.h"

#include <algorithm>
#include <cmath>

#include "pipeline/base/error.h"
#include "pipeline/base/parallel.h"
#include "pipeline/geometry/distribution.h"
#include "pipeline/geometry/extremes.h"
#include "pipeline/geometry/topology.h"

namespace periost {
namespace {

constexpr std::size_t kBlockTriangles = 2048;
constexpr int kMaxDepth = 12;
constexpr int kMaxPieces = 1024;  // per side of a triangle
// Spacings: below this a largest distance is taken as sampled. Where two surfaces are one but for their
// edges, every piece across an edge would else be cut down to nothing.
constexpr double kNoDistance = 0.01;

struct Piece {
  Vec3 a, b, c;
};

// A distance, its place, and the slot of the closest triangle as a hint for the next query.
struct Sample {
  double distance = 0;
  Vec3 place;
  Index slot = kNoIndex;
};

Sample sample(const SpatialSearch& to, Vec3 place, Index hint) {
  const SpatialSearch::Hit hit = to.closest(place, hint);
  return {std::sqrt(hit.squared_distance), place, hit.slot};
}

// No point of the piece is farther from the surface than this.
double upper_bound(const Piece& piece, const std::array<Vec3, 3>& facet) {
  double bound = 0;
  for (const Vec3 corner : {piece.a, piece.b, piece.c}) {
    bound =
        std::max(bound, distance(corner, closest_point_on_triangle(corner, facet[0], facet[1], facet[2])));
  }
  return bound;
}

int pieces_per_side(const Piece& triangle, double spacing) {
  const double longest = std::max(
      {distance(triangle.a, triangle.b), distance(triangle.b, triangle.c), distance(triangle.c, triangle.a)});
  return static_cast<int>(std::clamp(std::ceil(longest / spacing), 1.0, static_cast<double>(kMaxPieces)));
}

// Calls visit(piece) for the n * n equal pieces of a triangle.
template <class Visit>
void for_each_piece(const Piece& t, int n, Visit visit) {
  const Vec3 u = (t.b - t.a) / n, v = (t.c - t.a) / n;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; i + j < n; ++j) {
      const Vec3 corner = t.a + i * u + j * v;
      visit(Piece{corner, corner + u, corner + v});
      if (i + j + 1 < n) visit(Piece{corner + u + v, corner + v, corner + u});
    }
  }
}

// Searches a piece for distances above `largest`, which it raises, until no part can exceed it by more than
// the tolerance.
class Refinement {
 public:
  Refinement(const SpatialSearch& to, double tolerance, double smallest)
      : to_(to), tolerance_(tolerance), smallest_(smallest) {}

  void refine(const Piece& piece, const Sample& centre, Sample& largest, int depth = 0) const {
    if (centre.distance > largest.distance) largest = centre;
    const double enough = std::max(largest.distance * (1 + tolerance_), smallest_);
    if (depth == kMaxDepth || upper_bound(piece, to_.corners(centre.slot)) <= enough) return;
    const Vec3 ab = 0.5 * (piece.a + piece.b), bc = 0.5 * (piece.b + piece.c), ca = 0.5 * (piece.c + piece.a);
    for (const Piece& part :
         {Piece{piece.a, ab, ca}, Piece{ab, piece.b, bc}, Piece{ca, bc, piece.c}, Piece{bc, ca, ab}}) {
      refine(part, sample(to_, (part.a + part.b + part.c) / 3, centre.slot), largest, depth + 1);
    }
  }

 private:
  const SpatialSearch& to_;
  double tolerance_, smallest_;
};

double mean_edge(const SurfaceMesh& mesh) {
  double sum = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3 p = mesh.points[a], q = mesh.points[b], r = mesh.points[c];
    sum += distance(p, q) + distance(q, r) + distance(r, p);
  }
  return mesh.triangles.empty() ? 0 : sum / (3 * static_cast<double>(mesh.triangles.size()));
}

struct BlockResult {
  std::vector<WeightedValue> weighted;
  std::vector<Sample> largest;  // per triangle of the block
};

Piece piece_of(const SurfaceMesh& mesh, std::size_t t) {
  const auto& [a, b, c] = mesh.triangles[t];
  return {mesh.points[a], mesh.points[b], mesh.points[c]};
}

// First pass: three points of each piece, where quadratic functions integrate exactly, and the corners.
BlockResult sample_block(const SurfaceMesh& from, const SpatialSearch& to, double spacing, std::size_t begin,
                         std::size_t end) {
  BlockResult result;
  Index hint = kNoIndex;
  for (std::size_t t = begin; t < end; ++t) {
    const Piece triangle = piece_of(from, t);
    const int n = pieces_per_side(triangle, spacing);
    const double weight = norm(area_vector(triangle.a, triangle.b, triangle.c)) / (3.0 * n * n);
    Sample largest;
    const auto take = [&](Vec3 place) {
      const Sample s = sample(to, place, hint);
      hint = s.slot;
      if (s.distance >= largest.distance) largest = s;
      return s.distance;
    };
    for (const Vec3 corner : {triangle.a, triangle.b, triangle.c}) take(corner);
    for_each_piece(triangle, n, [&](const Piece& p) {
      const Vec3 sum = p.a + p.b + p.c;
      for (const Vec3 corner : {p.a, p.b, p.c})
        result.weighted.push_back({take(sum / 6 + 0.5 * corner), weight});
    });
    result.largest.push_back(largest);
  }
  return result;
}

DistanceSummary summary_of(std::vector<BlockResult>& blocks, double largest) {
  std::vector<WeightedValue> all;
  for (const BlockResult& block : blocks) all.insert(all.end(), block.weighted.begin(), block.weighted.end());
  double weight = 0, sum = 0, squares = 0;
  for (const WeightedValue& v : all) {
    weight += v.weight;
    sum += v.weight * v.value;
    squares += v.weight * v.value * v.value;
  }
  DistanceSummary summary;
  summary.max = largest;
  if (weight > 0) {
    summary.mean = sum / weight;
    summary.rms = std::sqrt(squares / weight);
  }
  summary.p99 = weighted_quantile(std::move(all), 0.99);
  return summary;
}

}  // namespace

OneSidedDistance distance_to(const SurfaceMesh& from, const SpatialSearch& to, const DistanceOptions& options,
                             const Context& context) {
  OneSidedDistance result;
  const std::size_t count = from.triangles.size();
  if (count == 0 || to.is_empty()) return result;
  const double spacing = options.spacing_mm > 0 ? options.spacing_mm : std::max(mean_edge(from), 1e-12);
  std::vector<BlockResult> blocks((count + kBlockTriangles - 1) / kBlockTriangles);
  parallel_blocks(context, count, kBlockTriangles, [&](std::size_t begin, std::size_t end) {
    blocks[begin / kBlockTriangles] = sample_block(from, to, spacing, begin, end);
  });
  Sample largest;
  for (const BlockResult& block : blocks) {
    for (const Sample& s : block.largest) largest = s.distance > largest.distance ? s : largest;
  }

  // Second pass: every block starts from the same maximum, so the result does not depend on their order.
  const Refinement refinement(to, options.max_tolerance, kNoDistance * spacing);
  parallel_blocks(context, count, kBlockTriangles, [&](std::size_t begin, std::size_t end) {
    BlockResult& block = blocks[begin / kBlockTriangles];
    Sample block_largest = largest;
    for (std::size_t t = begin; t < end; ++t) {
      const Piece triangle = piece_of(from, t);
      Sample found = block_largest;
      for_each_piece(triangle, pieces_per_side(triangle, spacing), [&](const Piece& piece) {
        const Sample centre = sample(to, (piece.a + piece.b + piece.c) / 3, block.largest[t - begin].slot);
        refinement.refine(piece, centre, found);
      });
      if (found.distance > block_largest.distance) block.largest[t - begin] = block_largest = found;
    }
  });
  Extremes extremes(Extremes::Side::kHighest);
  for (std::size_t t = 0; t < count; ++t) {
    const Sample& s = blocks[t / kBlockTriangles].largest[t % kBlockTriangles];
    extremes.add(t, s.distance, s.place);
  }
  result.worst = extremes.take();
  result.summary = summary_of(blocks, result.worst.front().value);
  return result;
}

TwoSidedDistance two_sided_distance(const SurfaceMesh& first, const SurfaceMesh& second,
                                    const DistanceOptions& options, const Context& context) {
  PERIOST_ASSERT(!first.triangles.empty() && !second.triangles.empty());
  DistanceOptions used = options;
  if (used.spacing_mm <= 0) used.spacing_mm = std::max(std::min(mean_edge(first), mean_edge(second)), 1e-12);
  TwoSidedDistance result;
  result.forward = distance_to(first, SpatialSearch(second, context), used, context);
  result.backward = distance_to(second, SpatialSearch(first, context), used, context);
  return result;
}

SurfaceDistance summarise(const TwoSidedDistance& distance, double voxel_mm,
                          std::optional<double> requested_mm) {
  const double unit = voxel_mm > 0 ? voxel_mm : 1;
  const auto scaled = [&](const DistanceSummary& s) {
    return DistanceSummary{s.max / unit, s.mean / unit, s.rms / unit, s.p99 / unit};
  };
  SurfaceDistance result;
  result.unit = voxel_mm > 0 ? "voxel" : "mm";
  result.surface_to_isosurface = scaled(distance.forward.summary);
  result.isosurface_to_surface = scaled(distance.backward.summary);
  result.hausdorff = std::max(result.surface_to_isosurface.max, result.isosurface_to_surface.max);
  if (requested_mm && *requested_mm > 0) {
    result.requested = *requested_mm / unit;
    result.over_requested = std::max(0.0, result.hausdorff / *result.requested - 1);
  }
  return result;
}

}  // namespace periost
