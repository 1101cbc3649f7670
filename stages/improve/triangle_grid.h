#pragma once
// Which triangles of a surface may lie in a box: a regular grid over the surface, made once.
#include <algorithm>
#include <array>
#include <vector>

#include "pipeline/data/surface_mesh.h"

namespace periost {

struct ImproveBox {
  Vec3 low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
  void take(Vec3 p) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  void widen(double margin);
  bool meets(const ImproveBox& other) const {
    return low.x <= other.high.x && other.low.x <= high.x && low.y <= other.high.y && other.low.y <= high.y &&
           low.z <= other.high.z && other.low.z <= high.z;
  }
  // From a point to the nearest of the box.
  double squared_distance(Vec3 p) const {
    const Vec3 gap{std::max({low.x - p.x, p.x - high.x, 0.0}), std::max({low.y - p.y, p.y - high.y, 0.0}),
                   std::max({low.z - p.z, p.z - high.z, 0.0})};
    return squared_norm(gap);
  }
};

// Linear in triangles to build, about 20 bytes a triangle and at most 8 MB beside. A query looks at the cells
// that the box meets.
class TriangleGrid {
 public:
  TriangleGrid(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles);

  // All triangles whose boxes meet `box` when the grid was made, and maybe others near, each once, in an
  // order that depends on the grid and the box alone.
  void find(const ImproveBox& box, std::vector<Index>& triangles) const;

 private:
  struct Range {
    int low[3], high[3];
  };
  Range cells_of(const ImproveBox& box) const;
  std::size_t cell(int i, int j, int k) const;

  Vec3 origin_;
  double side_ = 1;
  int dims_[3] = {1, 1, 1};
  std::vector<Index> first_;  // per cell
  std::vector<Index> entries_;
  std::vector<std::array<int, 3>> low_;  // per triangle: its lowest cell
};

}  // namespace periost
