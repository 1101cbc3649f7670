#include "stages/improve/tet_order.h"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "pipeline/base/morton.h"

namespace periost {
namespace {

constexpr double kCells = 1 << 20;  // along an axis

}  // namespace

TetMesh in_curve_order(const TetMesh& mesh) {
  Vec3 low{1e300, 1e300, 1e300}, high = -low;
  for (const Vec3 p : mesh.points) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const Vec3 size = high - low;
  const double per_mm = (kCells - 1) / std::max({size.x, size.y, size.z, 1e-300});
  std::vector<std::pair<std::uint64_t, Index>> keys;
  keys.reserve(mesh.tets.size());
  for (Index t = 0; t < mesh.tets.size(); ++t) {
    const auto& [a, b, c, d] = mesh.tets[t];
    const auto& p = mesh.points;
    const Vec3 cell = (0.25 * (p[a] + p[b] + p[c] + p[d]) - low) * per_mm;
    const auto part = [](double x) { return static_cast<std::uint64_t>(std::max(x, 0.0)); };
    keys.emplace_back(morton_code(part(cell.x), part(cell.y), part(cell.z)), t);
  }
  std::sort(keys.begin(), keys.end());
  TetMesh result;
  result.points = mesh.points;
  result.tets.reserve(keys.size());
  for (const auto& [key, t] : keys) result.tets.push_back(mesh.tets[t]);
  if (!mesh.region.empty()) {
    result.region.reserve(keys.size());
    for (const auto& [key, t] : keys) result.region.push_back(mesh.region[t]);
  }
  return result;
}

}  // namespace periost
