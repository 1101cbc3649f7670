#include "stages/marching_cubes/polygon.h"

#include <algorithm>

namespace periost {
namespace {

constexpr double kImpossible = -2;

// best[i][j]: of the triangulations of vertices i..j of the loop, the largest smallest angle, and the vertex
// `apex` of the triangle on chord (i, j) that gives it.
struct SpanTable {
  std::array<std::array<double, kCellEdges>, kCellEdges> best;
  std::array<std::array<std::uint8_t, kCellEdges>, kCellEdges> apex;
};

void solve_span(const CellLoop& loop, const std::array<Vec3, kCellEdges>& points, SpanTable& table,
                std::size_t i, std::size_t j) {
  table.best[i][j] = kImpossible;
  if ((loop.chords[i] >> j & 1) == 0) return;
  for (std::size_t k = i + 1; k < j; ++k) {
    const double sides = std::min(table.best[i][k], table.best[k][j]);
    if (sides <= table.best[i][j]) continue;
    const double value = std::min(sides, smallest_angle_measure(points[i], points[k], points[j]));
    if (value > table.best[i][j]) {
      table.best[i][j] = value;
      table.apex[i][j] = static_cast<std::uint8_t>(k);
    }
  }
}

void collect(const SpanTable& table, std::size_t i, std::size_t j, LoopTriangles& out) {
  if (j < i + 2) return;
  const std::size_t k = table.apex[i][j];
  out.triangles[static_cast<std::size_t>(out.count++)] = {
      static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(k), static_cast<std::uint8_t>(j)};
  collect(table, i, k, out);
  collect(table, k, j, out);
}

LoopTriangles triangulate_quad(const CellLoop& loop, const std::array<Vec3, kCellEdges>& p) {
  const auto worse = [&](std::size_t a, std::size_t b, std::size_t c, std::size_t d) {
    return std::min(smallest_angle_measure(p[a], p[b], p[c]), smallest_angle_measure(p[a], p[c], p[d]));
  };
  const double first = (loop.chords[0] >> 2 & 1) != 0 ? worse(0, 1, 2, 3) : kImpossible;
  const double second = (loop.chords[1] >> 3 & 1) != 0 ? worse(1, 2, 3, 0) : kImpossible;
  if (first == kImpossible && second == kImpossible) return {};
  if (first >= second) return {2, {{{0, 1, 2}, {0, 2, 3}}}};
  return {2, {{{1, 2, 3}, {1, 3, 0}}}};
}

}  // namespace

double smallest_angle_measure(Vec3 a, Vec3 b, Vec3 c) {
  // The smallest angle lies opposite the shortest side; it is at most 60 degrees, so its cosine is positive.
  std::array<double, 3> s{squared_norm(b - c), squared_norm(c - a), squared_norm(a - b)};
  if (s[0] > s[1]) std::swap(s[0], s[1]);
  if (s[0] > s[2]) std::swap(s[0], s[2]);
  const double twice_product_cos = s[1] + s[2] - s[0];
  const double product = 4 * s[1] * s[2];
  return product > 0 ? -twice_product_cos * twice_product_cos / product : -1;
}

LoopTriangles triangulate_loop(const CellLoop& loop, const std::array<Vec3, kCellEdges>& points) {
  const std::size_t n = loop.size;
  if (n == 3) return {1, {{{0, 1, 2}}}};
  if (n == 4) return triangulate_quad(loop, points);
  SpanTable table;
  for (std::size_t i = 0; i + 1 < n; ++i) table.best[i][i + 1] = 0;
  for (std::size_t span = 2; span < n; ++span) {
    for (std::size_t i = 0; i + span < n; ++i) solve_span(loop, points, table, i, i + span);
  }
  LoopTriangles out;
  if (table.best[0][n - 1] > kImpossible) collect(table, 0, n - 1, out);
  return out;
}

}  // namespace periost
