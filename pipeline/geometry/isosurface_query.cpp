#include "pipeline/geometry/isosurface_query.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace periost {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Barycentric slack of the line test: a line through an edge shared by two triangles must hit one of them.
constexpr double kEdgeSlack = 1e-9;

std::array<Vec3, 3> corners(const Isosurface& isosurface, Index triangle) {
  const auto& [a, b, c] = isosurface.surface.triangles[triangle];
  const auto& points = isosurface.surface.points;
  return {points[a], points[b], points[c]};
}

// A cell index as a number that cannot overflow, however far the point lies.
std::int32_t clamped_floor(double value) {
  return static_cast<std::int32_t>(std::clamp(std::floor(value), -1e9, 1e9));
}

// The search for the closest point, in the grid's own axes: x[a] is the query in units of voxels.
struct ClosestSearch {
  const Isosurface& isosurface;
  Vec3 p;
  Vec3 x;
  std::array<std::int32_t, 3> home{};
  double best_squared = 0;  // only strictly nearer points, or the same with a lower index, replace the best
  IsosurfacePoint best;

  // Squared distance in mm from p to the slab of cells with index `cell` along an axis.
  double axis_squared(int axis, std::int32_t cell) const {
    const auto a = static_cast<std::size_t>(axis);
    const double below = cell - x[a];
    const double above = x[a] - (cell + 1.0);
    const double gap = std::max({below, above, 0.0}) * isosurface.frame.spacing[a];
    return gap * gap;
  }

  // Smallest distance in mm from p to any cell of shell `radius` or beyond, squared.
  double shell_squared(std::int32_t radius) const {
    double nearest = kInfinity;
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      nearest =
          std::min({nearest, axis_squared(axis, home[a] - radius), axis_squared(axis, home[a] + radius)});
    }
    return nearest;
  }

  void test_cell(std::int32_t i, std::int32_t j, std::int32_t k) {
    const TriangleRange range = isosurface.triangles_of_cell(i, j, k);
    for (Index t = range.begin; t < range.end; ++t) {
      const auto [a, b, c] = corners(isosurface, t);
      const Vec3 q = closest_point_on_triangle(p, a, b, c);
      const double squared = squared_norm(q - p);
      if (squared < best_squared || (squared == best_squared && t < best.triangle)) {
        best_squared = squared;
        best.point = q;
        best.triangle = t;
      }
    }
  }

  // Visits the cells of row (j, k) of a shell: all of them on its faces, else its two ends.
  void test_row(std::int32_t j, std::int32_t k, std::int32_t radius, double row_squared) {
    const bool is_inside = std::abs(j - home[1]) < radius && std::abs(k - home[2]) < radius;
    const std::int32_t low = std::max(home[0] - radius, -1);
    const std::int32_t high = std::min(home[0] + radius, isosurface.frame.dims[0] - 1);
    for (std::int32_t i = low; i <= high; ++i) {
      if (is_inside && std::abs(i - home[0]) < radius) {
        i = home[0] + radius - 1;
        continue;
      }
      if (row_squared + axis_squared(0, i) <= best_squared) test_cell(i, j, k);
    }
  }

  // The 26 cells around the home cell.
  void test_neighbours() {
    std::array<std::array<double, 3>, 3> gap{};  // squared, by axis: below, none, above
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      gap[a] = {axis_squared(axis, home[a] - 1), 0, axis_squared(axis, home[a] + 1)};
    }
    for (std::size_t k = 0; k < 3; ++k) {
      if (gap[2][k] > best_squared) continue;
      for (std::size_t j = 0; j < 3; ++j) {
        const double row = gap[2][k] + gap[1][j];
        if (row > best_squared) continue;
        for (std::size_t i = 0; i < 3; ++i) {
          if ((i == 1 && j == 1 && k == 1) || row + gap[0][i] > best_squared) continue;
          test_cell(home[0] + static_cast<std::int32_t>(i) - 1, home[1] + static_cast<std::int32_t>(j) - 1,
                    home[2] + static_cast<std::int32_t>(k) - 1);
        }
      }
    }
  }

  void test_shell(std::int32_t radius) {
    if (radius == 0) return test_cell(home[0], home[1], home[2]);
    if (radius == 1) return test_neighbours();
    const auto& dims = isosurface.frame.dims;
    for (std::int32_t k = std::max(home[2] - radius, -1); k <= std::min(home[2] + radius, dims[2] - 1); ++k) {
      const double k_squared = axis_squared(2, k);
      if (k_squared > best_squared) continue;
      for (std::int32_t j = std::max(home[1] - radius, -1); j <= std::min(home[1] + radius, dims[1] - 1);
           ++j) {
        const double row_squared = k_squared + axis_squared(1, j);
        if (row_squared <= best_squared) test_row(j, k, radius, row_squared);
      }
    }
  }
};

// A walk through the cells on a ray (Amanatides and Woo 1987).
class CellWalk {
 public:
  // `x` and `direction` in units of voxels; `direction` per millimetre along the ray.
  CellWalk(Vec3 x, Vec3 direction) {
    for (std::size_t a = 0; a < 3; ++a) {
      cell_[a] = clamped_floor(x[a]);
      step_[a] = direction[a] > 0 ? 1 : -1;
      if (direction[a] == 0) continue;
      const double wall = direction[a] > 0 ? cell_[a] + 1.0 : cell_[a];
      delta_[a] = std::abs(1.0 / direction[a]);
      next_[a] = (wall - x[a]) / direction[a];
    }
  }
  // Distance along the ray at which it enters the cell.
  double entry() const { return entry_; }
  const std::array<std::int32_t, 3>& cell() const { return cell_; }
  void advance() {
    std::size_t a = next_[0] < next_[1] ? 0 : 1;
    if (next_[2] < next_[a]) a = 2;
    entry_ = next_[a];
    next_[a] += delta_[a];
    cell_[a] += step_[a];
  }

 private:
  std::array<std::int32_t, 3> cell_{};
  std::array<std::int32_t, 3> step_{};
  std::array<double, 3> next_{kInfinity, kInfinity, kInfinity};
  std::array<double, 3> delta_{kInfinity, kInfinity, kInfinity};
  double entry_ = 0;
};

// Signed distance along the line at which it meets the triangle from the side that faces against it, or
// infinity (Moeller and Trumbore 1997).
double line_hit(Vec3 p, Vec3 n, Vec3 a, Vec3 b, Vec3 c) {
  const Vec3 ab = b - a;
  const Vec3 ac = c - a;
  const Vec3 normal = cross(ab, ac);
  const double facing = dot(normal, n);
  if (!(facing > 0)) return kInfinity;
  const Vec3 ap = p - a;
  const Vec3 s = cross(n, ap);
  const double slack = kEdgeSlack * facing;
  const double v = dot(ac, s);
  if (v < -slack || v > facing + slack) return kInfinity;
  const double w = -dot(ab, s);
  if (w < -slack || v + w > facing + slack) return kInfinity;
  return -dot(normal, ap) / facing;
}

}  // namespace

Cell cell_at(const GridFrame& frame, Vec3 p) {
  const Vec3 x = frame.to_index(p);
  return {clamped_floor(x.x), clamped_floor(x.y), clamped_floor(x.z)};
}

Cell cell_of_triangle(const Isosurface& isosurface, Index triangle) {
  const auto& blocks = isosurface.blocks;
  const auto after =
      std::upper_bound(blocks.begin(), blocks.end(), triangle,
                       [](Index t, const CellBlock& block) { return t < block.first_triangle; });
  const auto block = static_cast<Index>(after - blocks.begin()) - 1;
  const auto& [first_cell, first_triangle, first] = blocks[block];
  const auto offset = triangle - first_triangle;
  const auto cell =
      static_cast<std::int32_t>(std::upper_bound(first.begin(), first.end(), offset) - first.begin()) - 1;
  constexpr std::int32_t kSide = CellBlock::kSide;
  return {first_cell[0] + cell % kSide, first_cell[1] + cell / kSide % kSide,
          first_cell[2] + cell / (kSide * kSide)};
}

std::optional<IsosurfacePoint> closest_point(const Isosurface& isosurface, Vec3 p, double within_mm) {
  const Vec3 x = isosurface.frame.to_index(p);
  ClosestSearch search{
      isosurface, p, x, {clamped_floor(x.x), clamped_floor(x.y), clamped_floor(x.z)}, within_mm * within_mm,
      {}};
  const auto& dims = isosurface.frame.dims;
  // The first shell that reaches the grid, and the last that does.
  std::int32_t first = 0;
  std::int32_t last = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    first = std::max({first, -1 - search.home[a], search.home[a] - (dims[a] - 1)});
    last = std::max({last, search.home[a] + 1, dims[a] - 1 - search.home[a]});
  }
  for (std::int32_t radius = first; radius <= last; ++radius) {
    if (radius > 0 && search.shell_squared(radius) > search.best_squared) break;
    search.test_shell(radius);
  }
  if (search.best.triangle == kNoIndex) return std::nullopt;
  search.best.distance = std::sqrt(search.best_squared);
  return search.best;
}

std::optional<IsosurfacePoint> closest_along_line(const Isosurface& isosurface, Vec3 p, Vec3 unit_normal,
                                                  double within_mm) {
  const GridFrame& frame = isosurface.frame;
  const Vec3 x = frame.to_index(p);
  const Vec3 local = frame.direction.transposed_times(unit_normal);
  const Vec3 direction{local.x / frame.spacing.x, local.y / frame.spacing.y, local.z / frame.spacing.z};
  CellWalk forward(x, direction);
  CellWalk backward(x, -direction);
  double nearest = within_mm;
  double along = 0;
  IsosurfacePoint hit;
  while (true) {
    CellWalk& walk = forward.entry() <= backward.entry() ? forward : backward;
    if (walk.entry() > nearest) break;
    const auto& [i, j, k] = walk.cell();
    const TriangleRange range = isosurface.triangles_of_cell(i, j, k);
    for (Index t = range.begin; t < range.end; ++t) {
      const auto [a, b, c] = corners(isosurface, t);
      const double distance = line_hit(p, unit_normal, a, b, c);
      if (std::abs(distance) < nearest || (std::abs(distance) == nearest && t < hit.triangle)) {
        nearest = std::abs(distance);
        along = distance;
        hit.triangle = t;
      }
    }
    walk.advance();
  }
  if (hit.triangle == kNoIndex) return std::nullopt;
  hit.point = p + unit_normal * along;
  hit.distance = nearest;
  return hit;
}

}  // namespace periost
