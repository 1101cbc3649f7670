#include "stages/improve/triangle_grid.h"

#include <algorithm>
#include <cmath>

namespace periost {
namespace {

constexpr double kMostCells = 2e6;

ImproveBox box_of(const std::vector<Vec3>& points, const Triangle& triangle) {
  ImproveBox box;
  for (const Index corner : triangle) box.take(points[corner]);
  return box;
}

}  // namespace

void ImproveBox::widen(double margin) {
  low = low - Vec3{margin, margin, margin};
  high = high + Vec3{margin, margin, margin};
}

TriangleGrid::TriangleGrid(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles) {
  ImproveBox whole;
  double sides = 0;
  for (const Triangle& triangle : triangles) {
    const ImproveBox box = box_of(points, triangle);
    whole.take(box.low);
    whole.take(box.high);
    const Vec3 size = box.high - box.low;
    sides += std::max({size.x, size.y, size.z});
  }
  if (triangles.empty()) whole = {{}, {}};
  origin_ = whole.low;
  const Vec3 size = whole.high - whole.low;
  const double mean = triangles.empty() ? 1 : sides / static_cast<double>(triangles.size());
  // Flat surfaces count as one mean triangle thick.
  const double volume = (size.x + mean) * (size.y + mean) * (size.z + mean);
  side_ = std::max({1.5 * mean, std::cbrt(volume / kMostCells), 1e-12});
  for (std::size_t a = 0; a < 3; ++a) dims_[a] = static_cast<int>(size[a] / side_) + 1;

  const auto cells = static_cast<std::size_t>(dims_[0]) * static_cast<std::size_t>(dims_[1]) *
                     static_cast<std::size_t>(dims_[2]);
  first_.assign(cells + 1, 0);
  const auto visit = [&](auto&& body) {
    for (Index t = 0; t < triangles.size(); ++t) {
      const Range range = cells_of(box_of(points, triangles[t]));
      for (int k = range.low[2]; k <= range.high[2]; ++k) {
        for (int j = range.low[1]; j <= range.high[1]; ++j) {
          for (int i = range.low[0]; i <= range.high[0]; ++i) body(cell(i, j, k), t);
        }
      }
    }
  };
  visit([&](std::size_t c, Index) { ++first_[c + 1]; });
  for (std::size_t c = 0; c < cells; ++c) first_[c + 1] += first_[c];
  entries_.resize(first_[cells]);
  std::vector<Index> next(first_.begin(), first_.end() - 1);
  visit([&](std::size_t c, Index t) { entries_[next[c]++] = t; });
  low_.reserve(triangles.size());
  for (const Triangle& triangle : triangles) {
    const Range range = cells_of(box_of(points, triangle));
    low_.push_back({range.low[0], range.low[1], range.low[2]});
  }
}

TriangleGrid::Range TriangleGrid::cells_of(const ImproveBox& box) const {
  Range range{};
  for (std::size_t a = 0; a < 3; ++a) {
    const auto index = [&](double x) {
      return static_cast<int>(std::clamp(std::floor((x - origin_[a]) / side_), -1.0, 1.0 * dims_[a]));
    };
    range.low[a] = std::max(index(box.low[a]), 0);
    range.high[a] = std::min(index(box.high[a]), dims_[a] - 1);
  }
  return range;
}

std::size_t TriangleGrid::cell(int i, int j, int k) const {
  return static_cast<std::size_t>(i) +
         static_cast<std::size_t>(dims_[0]) *
             (static_cast<std::size_t>(j) + static_cast<std::size_t>(dims_[1]) * static_cast<std::size_t>(k));
}

void TriangleGrid::find(const ImproveBox& box, std::vector<Index>& triangles) const {
  triangles.clear();
  const Range range = cells_of(box);
  for (int k = range.low[2]; k <= range.high[2]; ++k) {
    for (int j = range.low[1]; j <= range.high[1]; ++j) {
      for (int i = range.low[0]; i <= range.high[0]; ++i) {
        const std::size_t c = cell(i, j, k);
        for (Index e = first_[c]; e < first_[c + 1]; ++e) {
          // A triangle is told of in the first of the cells that both it and the box meet.
          const auto& low = low_[entries_[e]];
          if (i == std::max(low[0], range.low[0]) && j == std::max(low[1], range.low[1]) &&
              k == std::max(low[2], range.low[2])) {
            triangles.push_back(entries_[e]);
          }
        }
      }
    }
  }
}

}  // namespace periost
