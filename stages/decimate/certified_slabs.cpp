#include "stages/decimate/certified_slabs.h"

#include <algorithm>
#include <cmath>

namespace periost {
namespace {

constexpr double kBandVoxels = 16;  // half the width of a band, in largest voxel sides

// Calls visit(triangle, cell index along the axis) for all triangles, in order.
template <class Visit>
void for_triangles(const Isosurface& isosurface, int axis, Visit&& visit) {
  constexpr int kSide = CellBlock::kSide;
  for (const CellBlock& block : isosurface.blocks) {
    for (int c = 0; c < CellBlock::kCells; ++c) {
      const int offset = axis == 0 ? c % kSide : axis == 1 ? c / kSide % kSide : c / (kSide * kSide);
      const std::int32_t cell = block.first_cell[static_cast<std::size_t>(axis)] + offset;
      const auto at = static_cast<std::size_t>(c);
      for (Index t = block.first[at]; t < block.first[at + 1]; ++t) visit(block.first_triangle + t, cell);
    }
  }
}

// The plane inside of a slab that halves its triangles; its first when there is none inside.
std::int32_t middle_of(const std::vector<std::uint64_t>& count, Slab slab) {
  const auto count_of = [&](std::int32_t cell) { return count[static_cast<std::size_t>(cell) + 1]; };
  std::uint64_t all = 0, below = 0;
  for (std::int32_t c = slab.first; c < slab.last; ++c) all += count_of(c);
  for (std::int32_t c = slab.first; c + 1 < slab.last; ++c) {
    below += count_of(c);
    if (2 * below >= all) return c + 1;
  }
  return slab.first;
}

std::vector<Slab> slabs_between(const std::vector<std::int32_t>& planes, std::int32_t end) {
  std::vector<Slab> slabs;
  std::int32_t first = -1;
  for (const std::int32_t plane : planes) {
    slabs.push_back({first, plane});
    first = plane;
  }
  slabs.push_back({first, end});
  return slabs;
}

}  // namespace

SlabPlan plan_slabs(const Isosurface& isosurface, std::uint32_t pieces) {
  SlabPlan plan;
  plan.planes = choose_cut(isosurface, pieces);
  const auto axis = static_cast<std::size_t>(plan.planes.axis);
  const GridFrame& frame = isosurface.frame;
  const std::int32_t end = frame.dims[axis];
  plan.pieces = slabs_between(plan.planes.at, end);

  std::vector<std::uint64_t> count(static_cast<std::size_t>(end) + 1, 0);  // of cell c at c + 1
  for_triangles(isosurface, plan.planes.axis,
                [&](Index, std::int32_t cell) { ++count[static_cast<std::size_t>(cell) + 1]; });
  const int width = static_cast<int>(std::ceil(kBandVoxels * frame.largest_spacing() / frame.spacing[axis]));
  std::vector<std::int32_t> middles;
  for (const Slab& piece : plan.pieces) {
    const std::int32_t middle = middle_of(count, piece);
    // No plane may be where an open surface ends.
    if (middle <= std::max(piece.first, 0) || middle >= std::min(piece.last, end - 1)) continue;
    middles.push_back(middle);
    plan.bands.push_back({std::max(piece.first, middle - width), std::min(piece.last, middle + width)});
  }
  plan.shifted = slabs_between(middles, end);
  for (const std::int32_t plane : plan.planes.at) {
    const bool is_reached = std::any_of(plan.bands.begin(), plan.bands.end(), [&](const Slab& band) {
      return band.first == plane || band.last == plane;
    });
    if (!is_reached) continue;
    const auto next = std::upper_bound(middles.begin(), middles.end(), plane);
    const std::int32_t above = next == middles.end() ? end : *next;
    const std::int32_t below = next == middles.begin() ? -1 : *(next - 1);
    plan.seams.push_back({std::max(below, plane - width), std::min(above, plane + width)});
  }
  return plan;
}

Isosurface cut_slab(const Isosurface& isosurface, int axis, Slab slab) {
  CutPlanes planes{axis, {}};
  const bool has_below = slab.first > -1;
  if (has_below) planes.at.push_back(slab.first);
  if (slab.last < isosurface.frame.dims[static_cast<std::size_t>(axis)]) planes.at.push_back(slab.last);
  return cut_part(isosurface, planes, has_below ? 1 : 0);
}

std::vector<Index> triangles_of_slab(const Isosurface& isosurface, int axis, Slab slab) {
  std::vector<Index> found;
  for_triangles(isosurface, axis, [&](Index t, std::int32_t cell) {
    if (cell >= slab.first && cell < slab.last) found.push_back(t);
  });
  return found;
}

}  // namespace periost
