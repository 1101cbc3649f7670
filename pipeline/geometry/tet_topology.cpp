#include "pipeline/geometry/tet_topology.h"

#include <algorithm>
#include <numeric>
#include <tuple>

#include "pipeline/base/error.h"

namespace periost {
namespace {

// One side of one tetrahedron: `b` < `c` are the two larger corners, `face` = 4 * tet + k.
struct FaceUse {
  Index b = 0, c = 0;
  Index face = 0;
  bool same_corners(const FaceUse& other) const { return b == other.b && c == other.c; }
};

std::array<Index, 3> sorted_corners(const Tetrahedron& tet, std::size_t k) {
  std::array<Index, 3> corners{tet[kTetFaces[k][0]], tet[kTetFaces[k][1]], tet[kTetFaces[k][2]]};
  std::sort(corners.begin(), corners.end());
  return corners;
}

}  // namespace

TetFaces tet_faces(const std::vector<Tetrahedron>& tets, std::size_t points) {
  PERIOST_ASSERT(tets.size() < (std::size_t{1} << 30));
  // Counting sort by the smallest corner, then a short sort inside each bucket.
  std::vector<std::size_t> first(points + 1, 0);
  for (const Tetrahedron& tet : tets) {
    for (std::size_t k = 0; k < 4; ++k) ++first[sorted_corners(tet, k)[0] + 1];
  }
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<FaceUse> uses(4 * tets.size());
  std::vector<std::size_t> next(first.begin(), first.end() - 1);
  for (std::size_t t = 0; t < tets.size(); ++t) {
    for (std::size_t k = 0; k < 4; ++k) {
      const auto [a, b, c] = sorted_corners(tets[t], k);
      uses[next[a]++] = {b, c, static_cast<Index>(4 * t + k)};
    }
  }

  TetFaces faces;
  for (std::size_t p = 0; p < points; ++p) {
    const auto begin = uses.begin() + static_cast<std::ptrdiff_t>(first[p]);
    const auto end = uses.begin() + static_cast<std::ptrdiff_t>(first[p + 1]);
    std::sort(begin, end, [](const FaceUse& x, const FaceUse& y) {
      return std::tie(x.b, x.c, x.face) < std::tie(y.b, y.c, y.face);
    });
    for (auto run = begin; run != end;) {
      const auto stop = std::find_if(run, end, [&](const FaceUse& use) { return !use.same_corners(*run); });
      const auto count = stop - run;
      if (count == 1) {
        const Tetrahedron& tet = tets[run->face / 4];
        const auto& corners = kTetFaces[run->face % 4];
        faces.boundary.push_back({tet[corners[0]], tet[corners[1]], tet[corners[2]]});
      } else if (count == 2) {
        faces.interior.push_back({run->face / 4, (run + 1)->face / 4});
      } else {
        ++faces.overused;
      }
      run = stop;
    }
  }
  return faces;
}

}  // namespace periost
