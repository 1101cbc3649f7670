#include "pipeline/geometry/isosurface_components.h"

#include <algorithm>
#include <numeric>
#include <vector>

#include "pipeline/base/error.h"
#include "pipeline/geometry/topology.h"

namespace periost {
namespace {

// Per component, whether it is among the `count` that have the most triangles.
std::vector<bool> largest_of(const std::vector<std::uint32_t>& component, std::uint32_t components,
                             std::uint32_t count) {
  std::vector<std::size_t> size(components, 0);
  for (const std::uint32_t c : component) ++size[c];
  std::vector<std::uint32_t> order(components);
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return size[a] > size[b]; });
  std::vector<bool> is_kept(components, false);
  for (std::uint32_t rank = 0; rank < std::min(count, components); ++rank) is_kept[order[rank]] = true;
  return is_kept;
}

// Drops triangles from every block, whose own offsets move with them.
void drop_triangles(Isosurface& isosurface, const std::vector<bool>& is_kept) {
  std::vector<Triangle>& triangles = isosurface.surface.triangles;
  Index next = 0;
  if (!isosurface.has_voxels()) {
    for (std::size_t t = 0; t < is_kept.size(); ++t) {
      if (is_kept[t]) triangles[next++] = triangles[t];
    }
  }
  for (CellBlock& block : isosurface.blocks) {
    const Index begin = block.first_triangle;
    block.first_triangle = next;
    std::uint16_t cell_begin = block.first[0];
    for (std::size_t cell = 0; cell < CellBlock::kCells; ++cell) {
      const std::uint16_t cell_end = block.first[cell + 1];
      for (Index t = begin + cell_begin; t < begin + cell_end; ++t) {
        if (is_kept[t]) triangles[next++] = triangles[t];
      }
      cell_begin = cell_end;
      block.first[cell + 1] = static_cast<std::uint16_t>(next - block.first_triangle);
    }
  }
  triangles.resize(next);
}

void drop_unused_points(SurfaceMesh& surface) {
  std::vector<Index> number(surface.points.size(), kNoIndex);
  for (const Triangle& triangle : surface.triangles) {
    for (const Index v : triangle) number[v] = 0;
  }
  Index next = 0;
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (number[v] == kNoIndex) continue;
    surface.points[next] = surface.points[v];
    number[v] = next++;
  }
  surface.points.resize(next);
  for (Triangle& triangle : surface.triangles) {
    for (Index& v : triangle) v = number[v];
  }
}

}  // namespace

std::uint32_t keep_largest_surfaces(Isosurface& isosurface, std::uint32_t count) {
  PERIOST_ASSERT(count > 0);
  SurfaceMesh& surface = isosurface.surface;
  const std::vector<std::uint32_t> component = triangle_components(surface.triangles, surface.points.size());
  if (component.empty()) return 0;
  const std::uint32_t components = *std::max_element(component.begin(), component.end()) + 1;
  if (components <= count) return 0;
  const std::vector<bool> stays = largest_of(component, components, count);
  std::vector<bool> is_kept(component.size());
  for (std::size_t t = 0; t < component.size(); ++t) is_kept[t] = stays[component[t]];
  drop_triangles(isosurface, is_kept);
  drop_unused_points(surface);
  return components - count;
}

void drop_small_surfaces(Isosurface& isosurface, std::size_t least) {
  SurfaceMesh& surface = isosurface.surface;
  const auto is_small = in_small_component(surface.triangles, surface.points.size(), least);
  std::vector<bool> is_kept(is_small.size());
  for (std::size_t t = 0; t < is_small.size(); ++t) is_kept[t] = is_small[t] == 0;
  drop_triangles(isosurface, is_kept);
  drop_unused_points(surface);
}

}  // namespace periost
