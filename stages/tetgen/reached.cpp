#include "stages/tetgen/reached.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "pipeline/geometry/tet_quality.h"

namespace periost {
namespace {

// Of a sphere's radius through the corners to the shortest edge.
double radius_edge_ratio(const TetCorners& t) {
  const Vec3 a = t[1] - t[0], b = t[2] - t[0], c = t[3] - t[0];
  const Vec3 to_centre =
      squared_norm(a) * cross(b, c) + squared_norm(b) * cross(c, a) + squared_norm(c) * cross(a, b);
  const double radius = norm(to_centre) / (2 * std::abs(dot(a, cross(b, c))));
  double shortest = distance(t[0], t[1]);
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = i + 1; j < 4; ++j) shortest = std::min(shortest, distance(t[i], t[j]));
  }
  return radius / shortest;
}

struct QualityReached {
  double radius_edge = 0, dihedral_deg = 180, volume = 0;                 // the worst
  std::size_t over_radius_edge = 0, under_dihedral = 0, over_volume = 0;  // how many fall short
};

QualityReached quality_reached(const std::vector<Vec3>& points, const std::vector<Tetrahedron>& tets,
                               const TetgenOptions& options) {
  QualityReached reached;
  for (const auto& [a, b, c, d] : tets) {
    const TetCorners corners{points[a], points[b], points[c], points[d]};
    const double ratio = radius_edge_ratio(corners), angle = tet_dihedral_range(corners).min_deg,
                 volume = tet_volume(corners);
    reached.radius_edge = std::max(reached.radius_edge, ratio);
    reached.dihedral_deg = std::min(reached.dihedral_deg, angle);
    reached.volume = std::max(reached.volume, volume);
    reached.over_radius_edge += ratio > options.max_radius_edge ? 1 : 0;
    reached.under_dihedral += angle < options.min_dihedral.degrees ? 1 : 0;
    reached.over_volume += options.max_volume > 0 && volume > options.max_volume ? 1 : 0;
  }
  return reached;
}

}  // namespace

SizeReached sizes_reached(const std::vector<Vec3>& points, const std::vector<Tetrahedron>& tets,
                          std::size_t surface_points, const periost_tetgen::SizeGrid& grid) {
  std::vector<std::pair<Index, Index>> edges;
  for (const Tetrahedron& tet : tets) {
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t j = i + 1; j < 4; ++j) {
        if (std::max(tet[i], tet[j]) >= surface_points) edges.push_back(std::minmax(tet[i], tet[j]));
      }
    }
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  if (edges.empty()) return {};
  std::vector<double> ratios;
  ratios.reserve(edges.size());
  for (const auto& [a, b] : edges) {
    const double asked = std::max(size_at(grid, &points[a].x), size_at(grid, &points[b].x));
    ratios.push_back(distance(points[a], points[b]) / asked);
  }
  std::sort(ratios.begin(), ratios.end());
  return {ratios.size(), ratios[ratios.size() / 2], ratios[ratios.size() * 99 / 100]};
}

void log_reached(const std::vector<Vec3>& points, const std::vector<Tetrahedron>& tets,
                 std::size_t surface_points, const TetgenOptions& options,
                 const periost_tetgen::SizeGrid& grid, const Context& context) {
  const QualityReached reached = quality_reached(points, tets, options);
  std::string text = fmt::format(
      "radius-edge ratio: asked {}, reached {:.2f} ({} tetrahedra over); smallest dihedral angle: asked {} "
      "deg, "
      "reached {:.2f} ({} under)",
      to_text(options.max_radius_edge), reached.radius_edge, reached.over_radius_edge,
      to_text(options.min_dihedral.degrees), reached.dihedral_deg, reached.under_dihedral);
  if (options.max_volume > 0) {
    text += fmt::format("; volume: asked {} mm3, reached {:.4g} ({} over)", to_text(options.max_volume),
                        reached.volume, reached.over_volume);
  }
  context.info("tetgen.quality", text);
  if (grid.is_empty()) return;
  const SizeReached sizes = sizes_reached(points, tets, surface_points, grid);
  context.info(
      "tetgen.sizes",
      fmt::format("{} edges with an end inside: half are shorter than {:.2f} of the size asked for, 99 % "
                  "shorter than {:.2f}",
                  sizes.edges, sizes.median, sizes.p99));
}

}  // namespace periost
