#include "pipeline/geometry/self_intersection.h"

#include <algorithm>
#include <bit>
#include <limits>

#include "pipeline/base/morton.h"
#include "pipeline/base/parallel.h"
#include "pipeline/geometry/predicates.h"

namespace periost {
namespace {

struct Box {
  Vec3 low{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
           std::numeric_limits<double>::infinity()};
  Vec3 high = -low;

  void add(Vec3 p) {
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], p[k]);
      high[k] = std::max(high[k], p[k]);
    }
  }
  void add(const Box& other) {
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], other.low[k]);
      high[k] = std::max(high[k], other.high[k]);
    }
  }
  bool overlaps(const Box& other) const {
    return low.x <= other.high.x && other.low.x <= high.x && low.y <= other.high.y && other.low.y <= high.y &&
           low.z <= other.high.z && other.low.z <= high.z;
  }
};

// A balanced tree of boxes over the triangles in Morton order: leaf l holds the positions
// [l * kLeaf, (l + 1) * kLeaf), node n has the children 2n and 2n + 1, the root is node 1.
class BoxTree {
 public:
  explicit BoxTree(const SurfaceMesh& surface) : surface_(surface) {
    sort_triangles();
    build();
  }

  std::size_t size() const { return order_.size(); }

  // Appends the pairs of the triangle at `position` with those at later positions.
  void collect(std::size_t position, std::vector<std::pair<Index, Index>>& pairs) const {
    const Index i = order_[position];
    const Box& box = box_[position];
    std::array<std::size_t, 64> stack;
    std::size_t depth = 0;
    stack[depth++] = 1;
    while (depth > 0) {
      const std::size_t node = stack[--depth];
      if (last_position(node) <= position || !node_[node].overlaps(box)) continue;
      if (node < leaves_) {
        stack[depth++] = 2 * node;
        stack[depth++] = 2 * node + 1;
        continue;
      }
      const std::size_t first = std::max((node - leaves_) * kLeaf, position + 1);
      const std::size_t end = std::min((node - leaves_ + 1) * kLeaf, size());
      for (std::size_t other = first; other < end; ++other) {
        const Index j = order_[other];
        if (box_[other].overlaps(box) &&
            triangles_intersect(surface_.points, surface_.triangles[i], surface_.triangles[j])) {
          pairs.emplace_back(std::min(i, j), std::max(i, j));
        }
      }
    }
  }

 private:
  static constexpr std::size_t kLeaf = 4;

  Box box_of(Index triangle) const {
    Box box;
    for (const Index corner : surface_.triangles[triangle]) box.add(surface_.points[corner]);
    return box;
  }

  void sort_triangles() {
    Box all;
    for (const Vec3& point : surface_.points) all.add(point);
    Vec3 scale;
    for (std::size_t k = 0; k < 3; ++k) {
      const double extent = all.high[k] - all.low[k];
      scale[k] = extent > 0 ? 2097151.0 / extent : 0;
    }
    std::vector<std::pair<std::uint64_t, Index>> keys;
    for (Index t = 0; t < surface_.triangles.size(); ++t) {
      const Triangle& corner = surface_.triangles[t];
      if (corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0]) continue;
      const Box box = box_of(t);
      const auto cell = [&](std::size_t k) {
        const double centre = 0.5 * (box.low[k] + box.high[k]) - all.low[k];
        return static_cast<std::uint64_t>(centre * scale[k]);
      };
      keys.emplace_back(morton_code(cell(0), cell(1), cell(2)), t);
    }
    std::sort(keys.begin(), keys.end());
    order_.reserve(keys.size());
    box_.reserve(keys.size());
    for (const auto& [code, triangle] : keys) {
      order_.push_back(triangle);
      box_.push_back(box_of(triangle));
    }
  }

  void build() {
    leaves_ = std::bit_ceil(std::max<std::size_t>((size() + kLeaf - 1) / kLeaf, 1));
    node_.resize(2 * leaves_);
    for (std::size_t position = 0; position < size(); ++position) {
      node_[leaves_ + position / kLeaf].add(box_[position]);
    }
    for (std::size_t node = leaves_ - 1; node >= 1; --node) {
      node_[node] = node_[2 * node];
      node_[node].add(node_[2 * node + 1]);
    }
  }

  std::size_t last_position(std::size_t node) const {
    const int levels_below = std::countl_zero(node) - std::countl_zero(leaves_);
    return (((node + 1) << levels_below) - leaves_) * kLeaf - 1;
  }

  const SurfaceMesh& surface_;
  std::vector<Index> order_;  // triangles by position
  std::vector<Box> box_;      // by position
  std::size_t leaves_ = 1;    // a power of two
  std::vector<Box> node_;
};

}  // namespace

std::vector<std::pair<Index, Index>> self_intersections(const SurfaceMesh& surface, const Context& context,
                                                        std::size_t limit) {
  constexpr std::size_t kBlock = 2048;
  const BoxTree tree(surface);
  std::vector<std::vector<std::pair<Index, Index>>> found((tree.size() + kBlock - 1) / kBlock);
  parallel_blocks(context, tree.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t position = begin; position < end; ++position) {
      tree.collect(position, found[begin / kBlock]);
    }
  });
  std::vector<std::pair<Index, Index>> pairs;
  for (const auto& part : found) pairs.insert(pairs.end(), part.begin(), part.end());
  std::sort(pairs.begin(), pairs.end());
  if (pairs.size() > limit) pairs.resize(limit);
  return pairs;
}

}  // namespace periost
