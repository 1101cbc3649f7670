#pragma once
// Which triangles of a surface may lie in a box: a regular grid over the surface, made once.
#include <vector>

#include "pipeline/data/surface_mesh.h"

namespace periost {

struct ImproveBox {
  Vec3 low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
  void take(Vec3 p);
  void widen(double margin);
};

// Linear in triangles to build, about 8 bytes a triangle and at most 8 MB beside. A query looks at the cells
// that the box meets.
class TriangleGrid {
 public:
  TriangleGrid(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles);

  // All triangles whose boxes meet `box` when the grid was made, and maybe others near; ascending.
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
};

}  // namespace periost
