#include "pipeline/geometry/spatial_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "pipeline/base/error.h"
#include "pipeline/base/parallel.h"

namespace periost {
namespace {

constexpr std::size_t kLeafTriangles = 4;
constexpr std::size_t kParallelLeaves = 4096;  // ranges of at most so many leaves are built in parallel

float below(double x) {
  const auto f = static_cast<float>(x);
  return static_cast<double>(f) <= x ? f : std::nextafter(f, -std::numeric_limits<float>::infinity());
}
float above(double x) {
  const auto f = static_cast<float>(x);
  return static_cast<double>(f) >= x ? f : std::nextafter(f, std::numeric_limits<float>::infinity());
}

}  // namespace

SpatialSearch::SpatialSearch(const SurfaceMesh& mesh, const Context& context) {
  const std::size_t count = mesh.triangles.size();
  if (count == 0) return;
  std::vector<Vec3> centres(count);
  for (std::size_t t = 0; t < count; ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    centres[t] = (mesh.points[a] + mesh.points[b] + mesh.points[c]) / 3;
  }
  triangle_.resize(count);
  std::iota(triangle_.begin(), triangle_.end(), Index{0});
  leaves_ = (count + kLeafTriangles - 1) / kLeafTriangles;
  nodes_.resize(leaves_);

  // The upper levels are split one after the other, level by level; the ranges below them are independent.
  using Range = std::pair<std::size_t, std::size_t>;
  std::vector<Range> upper, lower, queue{{0, leaves_}};
  while (!queue.empty()) {
    std::vector<Range> next;
    parallel_for(context, queue.size(), [&](std::size_t i) {
      if (queue[i].second - queue[i].first > kParallelLeaves) split(queue[i].first, queue[i].second, centres);
    });
    for (const auto& [begin, end] : queue) {
      if (end - begin <= kParallelLeaves) {
        lower.push_back({begin, end});
        continue;
      }
      upper.push_back({begin, end});
      next.push_back({begin, (begin + end) / 2});
      next.push_back({(begin + end) / 2, end});
    }
    queue = std::move(next);
  }
  corners_.resize(count);
  std::vector<std::pair<Range, Box>> boxes(lower.size());
  parallel_for(context, lower.size(), [&](std::size_t i) {
    const auto [begin, end] = lower[i];
    split_all(begin, end, centres);
    for (std::size_t slot = leaf_begin(begin); slot < leaf_begin(end); ++slot) {
      const auto& [a, b, c] = mesh.triangles[triangle_[slot]];
      corners_[slot] = {mesh.points[a], mesh.points[b], mesh.points[c]};
    }
    boxes[i] = {lower[i], build(begin, end)};
  });
  // Upper nodes take their boxes from below, deepest first.
  const auto box_of = [&](Range range) {
    const auto found =
        std::find_if(boxes.begin(), boxes.end(), [&](const auto& entry) { return entry.first == range; });
    if (found != boxes.end()) return found->second;
    const Node& node = nodes_[(range.first + range.second) / 2];
    return joined(node.left, node.right);
  };
  for (auto range = upper.rbegin(); range != upper.rend(); ++range) {
    const std::size_t middle = (range->first + range->second) / 2;
    nodes_[middle] = {box_of({range->first, middle}), box_of({middle, range->second})};
  }
}

std::size_t SpatialSearch::leaf_begin(std::size_t leaf) const {
  return std::min(leaf * kLeafTriangles, triangle_.size());
}

void SpatialSearch::split(std::size_t begin, std::size_t end, const std::vector<Vec3>& centres) {
  const std::size_t first = leaf_begin(begin), middle = leaf_begin((begin + end) / 2), last = leaf_begin(end);
  Vec3 low = centres[triangle_[first]], high = low;
  for (std::size_t slot = first; slot < last; ++slot) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], centres[triangle_[slot]][axis]);
      high[axis] = std::max(high[axis], centres[triangle_[slot]][axis]);
    }
  }
  const Vec3 extent = high - low;
  const std::size_t axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
  const auto at = [&](std::size_t slot) { return triangle_.begin() + static_cast<std::ptrdiff_t>(slot); };
  std::nth_element(at(first), at(middle), at(last), [&](Index a, Index b) {
    return std::pair(centres[a][axis], a) < std::pair(centres[b][axis], b);
  });
}

void SpatialSearch::split_all(std::size_t begin, std::size_t end, const std::vector<Vec3>& centres) {
  if (end - begin < 2) return;
  split(begin, end, centres);
  split_all(begin, (begin + end) / 2, centres);
  split_all((begin + end) / 2, end, centres);
}

SpatialSearch::Box SpatialSearch::build(std::size_t begin, std::size_t end) {
  if (end - begin == 1) return leaf_box(begin);
  const std::size_t middle = (begin + end) / 2;
  const Box left = build(begin, middle), right = build(middle, end);
  nodes_[middle] = {left, right};
  return joined(left, right);
}

SpatialSearch::Box SpatialSearch::leaf_box(std::size_t leaf) const {
  Vec3 low = corners_[leaf_begin(leaf)][0], high = low;
  for (std::size_t slot = leaf_begin(leaf); slot < leaf_begin(leaf + 1); ++slot) {
    for (const Vec3& corner : corners_[slot]) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        low[axis] = std::min(low[axis], corner[axis]);
        high[axis] = std::max(high[axis], corner[axis]);
      }
    }
  }
  return {{below(low.x), below(low.y), below(low.z)}, {above(high.x), above(high.y), above(high.z)}};
}

SpatialSearch::Box SpatialSearch::joined(const Box& a, const Box& b) {
  Box box;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    box.low[axis] = std::min(a.low[axis], b.low[axis]);
    box.high[axis] = std::max(a.high[axis], b.high[axis]);
  }
  return box;
}

double SpatialSearch::squared_distance(const Box& box, Vec3 p) {
  double sum = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double outside = std::max(
        {static_cast<double>(box.low[axis]) - p[axis], p[axis] - static_cast<double>(box.high[axis]), 0.0});
    sum += outside * outside;
  }
  return sum;
}

void SpatialSearch::search_leaf(std::size_t leaf, Vec3 p, Hit& best) const {
  const std::size_t end = leaf_begin(leaf + 1);
  for (std::size_t slot = leaf_begin(leaf); slot < end; ++slot) {
    const auto& [a, b, c] = corners_[slot];
    const Vec3 point = closest_point_on_triangle(p, a, b, c);
    const double squared = squared_norm(p - point);
    if (squared < best.squared_distance) best = {squared, point, triangle_[slot], static_cast<Index>(slot)};
  }
}

SpatialSearch::Hit SpatialSearch::closest(Vec3 p, Index hint_slot) const {
  PERIOST_ASSERT(!is_empty());
  Hit best{std::numeric_limits<double>::infinity(), {}, kNoIndex, kNoIndex};
  if (hint_slot != kNoIndex) search_leaf(hint_slot / kLeafTriangles, p, best);
  struct Entry {
    std::size_t begin, end;
    double squared_distance;
  };
  std::array<Entry, 64> stack;  // the tree is balanced: depth below 32
  std::size_t size = 0;
  stack[size++] = {0, leaves_, 0};
  while (size > 0) {
    const Entry entry = stack[--size];
    if (entry.squared_distance >= best.squared_distance) continue;
    if (entry.end - entry.begin == 1) {
      search_leaf(entry.begin, p, best);
      continue;
    }
    const std::size_t middle = (entry.begin + entry.end) / 2;
    const Node& node = nodes_[middle];
    const Entry left{entry.begin, middle, squared_distance(node.left, p)};
    const Entry right{middle, entry.end, squared_distance(node.right, p)};
    const bool left_is_nearer = left.squared_distance <= right.squared_distance;
    stack[size++] = left_is_nearer ? right : left;
    stack[size++] = left_is_nearer ? left : right;
  }
  return best;
}

}  // namespace periost
