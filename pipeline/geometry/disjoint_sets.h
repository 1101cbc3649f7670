#pragma once
// Union and find over the numbers 0 .. count - 1. Each set is named by its least member, whatever the order
// of unions, so labels made from names are deterministic. Amortised O(log n) an operation; no allocation
// after construction.
#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

#include "pipeline/data/surface_mesh.h"

namespace periost {

class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), Index{0});
  }
  // The least member of the set of x.
  Index find(Index x) {
    while (parent_[x] != x) x = parent_[x] = parent_[parent_[x]];
    return x;
  }
  void unite(Index x, Index y) {
    x = find(x);
    y = find(y);
    parent_[std::max(x, y)] = std::min(x, y);
  }

 private:
  std::vector<Index> parent_;
};

}  // namespace periost
