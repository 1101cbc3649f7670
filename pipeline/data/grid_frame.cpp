#include "pipeline/data/grid_frame.h"

namespace periost {

bool same_grid(const GridFrame& a, const GridFrame& b, double tolerance) {
  if (a.dims != b.dims) return false;
  const double limit = tolerance * std::min({a.spacing.x, a.spacing.y, a.spacing.z});
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 index{(corner & 1) != 0 ? a.dims[0] - 1.0 : 0.0, (corner & 2) != 0 ? a.dims[1] - 1.0 : 0.0,
                     (corner & 4) != 0 ? a.dims[2] - 1.0 : 0.0};
    if (!(distance(a.to_lps(index), b.to_lps(index)) <= limit)) return false;
  }
  return true;
}

}  // namespace periost
