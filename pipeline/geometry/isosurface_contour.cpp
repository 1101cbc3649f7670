#include "pipeline/geometry/isosurface_contour.h"

#include <algorithm>
#include <cmath>

#include "pipeline/geometry/topology.h"

namespace periost {
namespace {

Vec3 closest_on_segment(Vec3 p, Vec3 a, Vec3 b) {
  const Vec3 along = b - a;
  const double length2 = squared_norm(along);
  if (length2 == 0) return a;
  return a + std::clamp(dot(p - a, along) / length2, 0.0, 1.0) * along;
}

}  // namespace

std::vector<std::uint8_t> open_sides(const SurfaceMesh& surface) {
  const auto neighbours = triangle_neighbours(surface.triangles, surface.points.size());
  std::vector<std::uint8_t> open(neighbours.size(), 0);
  bool any = false;
  for (std::size_t t = 0; t < neighbours.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (neighbours[t][k] != kNoIndex) continue;
      open[t] = static_cast<std::uint8_t>(open[t] | 1u << k);
      any = true;
    }
  }
  if (!any) open.clear();
  return open;
}

std::optional<ContourPoint> closest_on_contour(const Isosurface& isosurface,
                                               const std::vector<std::uint8_t>& open, Vec3 p, Vec3 direction,
                                               double within_mm) {
  if (open.empty()) return std::nullopt;
  const GridFrame& frame = isosurface.frame;
  const Vec3 index = frame.to_index(p);
  std::array<std::int32_t, 3> low{}, high{};
  for (std::size_t a = 0; a < 3; ++a) {
    const double reach = within_mm / frame.spacing[a] + 1e-9;
    low[a] = static_cast<std::int32_t>(std::floor(std::clamp(index[a] - reach, -2.0, 1e9)));
    high[a] = static_cast<std::int32_t>(std::floor(std::clamp(index[a] + reach, -2.0, 1e9)));
    low[a] = std::max(low[a], -1);
    high[a] = std::min(high[a], frame.dims[a] - 1);
  }
  std::optional<ContourPoint> best;
  Index best_triangle = kNoIndex;
  const auto try_side = [&](Index t, std::size_t k) {
    const Triangle& corners = isosurface.surface.triangles[t];
    const Vec3 a = isosurface.surface.points[corners[(k + 1) % 3]],
               b = isosurface.surface.points[corners[(k + 2) % 3]];
    if (direction != Vec3{} && !(dot(b - a, direction) > 0)) return;
    const Vec3 q = closest_on_segment(p, a, b);
    const double d = distance(p, q);
    if (d > within_mm || (best && (d > best->distance || (d == best->distance && t > best_triangle)))) return;
    best = ContourPoint{q, d, normalized(b - a)};
    best_triangle = t;
  };
  for (std::int32_t k = low[2]; k <= high[2]; ++k) {
    for (std::int32_t j = low[1]; j <= high[1]; ++j) {
      for (std::int32_t i = low[0]; i <= high[0]; ++i) {
        const TriangleRange range = isosurface.triangles_of_cell(i, j, k);
        for (Index t = range.begin; t < range.end; ++t) {
          for (std::size_t side = 0; side < 3; ++side) {
            if ((open[t] >> side & 1) != 0) try_side(t, side);
          }
        }
      }
    }
  }
  return best;
}

}  // namespace periost
