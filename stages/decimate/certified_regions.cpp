#include "stages/decimate/certified_regions.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <iterator>
#include <limits>

#include "pipeline/base/parallel.h"

namespace periost {
namespace {

constexpr double kRegionMargin = 1e-3;  // voxels from a plane at which a vertex counts as on it
constexpr double kLeastExtent = 8;      // cells across a region that may be cut
constexpr std::uint8_t kRegionLock = 2;
constexpr std::size_t kBlock = 8192;                            // elements of one task
constexpr std::array<double, 4> kShare{0.5, 0.36, 0.64, 0.43};  // of the vertices before the plane, by turn

// Where a plane between cells splits the vertices in about the share asked; false when there is no room.
bool choose_plane(const std::vector<Vec3>& place, const std::vector<Index>& vertices, double side,
                  double share, std::size_t& axis, double& plane) {
  Vec3 lo{1e300, 1e300, 1e300}, hi{-1e300, -1e300, -1e300};
  for (const Index v : vertices) {
    for (std::size_t k = 0; k < 3; ++k) {
      lo[k] = std::min(lo[k], place[v][k]);
      hi[k] = std::max(hi[k], place[v][k]);
    }
  }
  axis = 0;
  for (std::size_t k = 1; k < 3; ++k) {
    if (hi[k] - lo[k] > hi[axis] - lo[axis]) axis = k;
  }
  if (hi[axis] - lo[axis] < kLeastExtent * side) return false;
  std::vector<double> coordinates;
  coordinates.reserve(vertices.size());
  for (const Index v : vertices) coordinates.push_back(place[v][axis]);
  const auto at =
      coordinates.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(coordinates.size()));
  std::nth_element(coordinates.begin(), at, coordinates.end());
  plane = side * std::round(*at / side);
  return plane > lo[axis] + side && plane < hi[axis] - side;
}

// How space is cut: see cut_regions. `side`: of a cell of the grid of sheets.
struct Cut {
  const std::vector<Vec3>& place;
  double side, share;
  std::size_t most;
};

// The regions of a region, the ones below a plane first; both sides of it at the same time.
std::vector<Region> regions_of(const Cut& cut, Region region, const Context& context) {
  const auto& [place, side, share, most] = cut;
  std::size_t axis = 0;
  double plane = 0;
  std::vector<Region> regions;
  if (region.vertices.size() <= most || !choose_plane(place, region.vertices, side, share, axis, plane)) {
    regions.push_back(std::move(region));
    return regions;
  }
  Region below{region.lo, region.hi, {}}, above{region.lo, region.hi, {}};
  below.hi[axis] = plane - kRegionMargin;
  above.lo[axis] = plane + kRegionMargin;
  for (const Index v : region.vertices) (place[v][axis] < plane ? below : above).vertices.push_back(v);
  region.vertices.clear();
  region.vertices.shrink_to_fit();
  std::array<std::vector<Region>, 2> halves;
  parallel_for(context, 2, [&](std::size_t half) {
    halves[half] = regions_of(cut, std::move(half == 0 ? below : above), context);
  });
  for (auto& half : halves) std::move(half.begin(), half.end(), std::back_inserter(regions));
  return regions;
}

bool is_at_border(const Region& region, Vec3 place) {
  for (std::size_t k = 0; k < 3; ++k) {
    if (place[k] < region.lo[k] || place[k] > region.hi[k]) return true;
  }
  return false;
}

// Locks what lies next to another region, or on a plane.
void lock_borders(CertifiedMesh& mesh, const std::vector<Vec3>& place, const std::vector<Region>& regions,
                  const Context& context) {
  std::vector<std::uint32_t> region_of(mesh.points.size(), 0);
  parallel_for(context, regions.size(), [&](std::size_t r) {
    for (const Index v : regions[r].vertices) {
      region_of[v] = static_cast<std::uint32_t>(r);
      if (is_at_border(regions[r], place[v])) mesh.is_locked[v] |= kRegionLock;
    }
  });
  parallel_blocks(context, mesh.triangles.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const LinkedTriangle& t = mesh.triangles[i];
      if (!t.is_alive()) continue;
      const auto r = region_of[t.corner[0]];
      if (region_of[t.corner[1]] == r && region_of[t.corner[2]] == r) continue;
      for (const Index v : t.corner) {
        std::atomic_ref(mesh.is_locked[v]).fetch_or(kRegionLock, std::memory_order_relaxed);
      }
    }
  });
}

}  // namespace

std::vector<Region> cut_regions(CertifiedState& state, std::size_t most, unsigned turn,
                                const Context& context) {
  CertifiedMesh& mesh = state.mesh;
  constexpr double kFar = std::numeric_limits<double>::max();
  Region all{{-kFar, -kFar, -kFar}, {kFar, kFar, kFar}, {}};
  std::vector<Vec3> place(mesh.points.size());
  parallel_blocks(context, place.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      mesh.is_locked[v] &= static_cast<std::uint8_t>(~kRegionLock);
      if (mesh.incident[v] != kNoIndex) place[v] = state.reference.frame().to_index(mesh.points[v]);
    }
  });
  for (Index v = 0; v < place.size(); ++v) {
    if (mesh.incident[v] != kNoIndex) all.vertices.push_back(v);
  }
  const Cut cut{place, state.sheets.side(), kShare[turn % kShare.size()], most};
  std::vector<Region> regions = regions_of(cut, std::move(all), context);
  if (regions.size() > 1) {
    lock_borders(mesh, place, regions, context);
    state.sheets.purge(mesh, context);
  }
  return regions;
}

}  // namespace periost
