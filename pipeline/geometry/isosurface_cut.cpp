#include "pipeline/geometry/isosurface_cut.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "pipeline/base/error.h"
#include "pipeline/geometry/topology.h"

namespace periost {
namespace {

using CellIndex = std::array<std::int32_t, 3>;

CellIndex cell_at_offset(const CellBlock& block, int cell) {
  constexpr int kSide = CellBlock::kSide;
  return {block.first_cell[0] + cell % kSide, block.first_cell[1] + cell / kSide % kSide,
          block.first_cell[2] + cell / (kSide * kSide)};
}

// Calls visit(cell, begin, end) for every cell that holds triangles, in their order.
template <class Visit>
void for_each_cell(const Isosurface& isosurface, Visit visit) {
  for (const CellBlock& block : isosurface.blocks) {
    for (int c = 0; c < CellBlock::kCells; ++c) {
      const Index begin = block.first_triangle + block.first[static_cast<std::size_t>(c)];
      const Index end = block.first_triangle + block.first[static_cast<std::size_t>(c) + 1];
      if (begin != end) visit(cell_at_offset(block, c), begin, end);
    }
  }
}

// Disjoint sets of points; a point not touched yet is its own set.
class Curves {
 public:
  explicit Curves(std::size_t points) : parent_(points, kNoIndex) {}
  // Whether p is new.
  bool touch(Index p) {
    if (parent_[p] != kNoIndex) return false;
    parent_[p] = p;
    return true;
  }
  // Whether p and q were in different sets.
  bool join(Index p, Index q) {
    p = root(p);
    q = root(q);
    parent_[std::max(p, q)] = std::min(p, q);
    return p != q;
  }

 private:
  Index root(Index p) {
    while (parent_[p] != p) p = parent_[p] = parent_[parent_[p]];
    return p;
  }
  std::vector<Index> parent_;
};

// Of points: the plane across the axis that each lies on; -1 for none.
std::vector<std::int32_t> planes_of_points(const Isosurface& isosurface, std::size_t axis) {
  constexpr double kOnPlane = 1e-6;  // voxels
  std::vector<std::int32_t> planes;
  planes.reserve(isosurface.surface.points.size());
  for (const Vec3 point : isosurface.surface.points) {
    const double q = isosurface.frame.to_index(point)[axis], nearest = std::round(q);
    planes.push_back(std::abs(q - nearest) < kOnPlane ? static_cast<std::int32_t>(nearest) : -1);
  }
  return planes;
}

// Whether one of these triangles has the side from p to q.
bool has_side(const SurfaceMesh& surface, Index begin, Index end, Index p, Index q) {
  for (Index t = begin; t < end; ++t) {
    const Triangle& c = surface.triangles[t];
    for (std::size_t k = 0; k < 3; ++k) {
      if (c[k] == p && c[(k + 1) % 3] == q) return true;
    }
  }
  return false;
}

// Triangles in cells below each plane c, c from 0 to dims.
std::vector<std::uint64_t> triangles_below(const Isosurface& isosurface, std::size_t axis) {
  std::vector<std::uint64_t> below(static_cast<std::size_t>(isosurface.frame.dims[axis]) + 2, 0);
  for_each_cell(isosurface, [&](const CellIndex& cell, Index begin, Index end) {
    below[static_cast<std::size_t>(cell[axis]) + 1] += end - begin;  // cells -1 .. dims - 1
  });
  // Now the count of cell c stands at c + 1; cells below plane c are -1 .. c - 1.
  std::partial_sum(below.begin(), below.end(), below.begin());
  return below;
}

// The best plane for a cut that leaves `ideal` triangles below it, or 0 when there is none above `previous`.
std::int32_t choose_plane(const std::vector<CutCost>& cost, const std::vector<std::uint64_t>& below,
                          double ideal, double slack, std::int32_t previous) {
  const auto last = static_cast<std::int32_t>(cost.size()) - 2;
  const auto miss = [&](std::int32_t c) {
    return std::abs(static_cast<double>(below[static_cast<std::size_t>(c)]) - ideal);
  };
  // Planes within the slack compete by cost; where there are none, by how far they miss.
  const auto is_better = [&](std::int32_t a, std::int32_t b) {
    const bool a_fits = miss(a) <= slack, b_fits = miss(b) <= slack;
    if (a_fits != b_fits) return a_fits;
    const CutCost &ca = cost[static_cast<std::size_t>(a)], &cb = cost[static_cast<std::size_t>(b)];
    if (a_fits && ca.contours != cb.contours) return ca.contours < cb.contours;
    if (a_fits && ca.length_mm != cb.length_mm) return ca.length_mm < cb.length_mm;
    return miss(a) < miss(b);
  };
  std::int32_t best = 0;
  for (std::int32_t c = std::max(previous + 1, 1); c <= last; ++c) {
    if (best == 0 || is_better(c, best)) best = c;
  }
  return best;
}

// New numbers of the points that the triangles use, in their order; shrinks the table.
void rebuild_vertex_table(const std::vector<Vec3>& points, SurfaceMesh& surface) {
  std::vector<Index> number(points.size(), kNoIndex);
  for (const Triangle& triangle : surface.triangles) {
    for (const Index p : triangle) number[p] = 0;
  }
  for (std::size_t p = 0; p < points.size(); ++p) {
    if (number[p] == kNoIndex) continue;
    number[p] = static_cast<Index>(surface.points.size());
    surface.points.push_back(points[p]);
  }
  for (Triangle& triangle : surface.triangles) {
    for (Index& p : triangle) p = number[p];
  }
}

// The ends of edges with one triangle, ascending.
std::vector<Index> border_points(const SurfaceMesh& surface) {
  const auto neighbours = triangle_neighbours(surface.triangles, surface.points.size());
  std::vector<Index> border;
  for (std::size_t t = 0; t < neighbours.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (neighbours[t][k] != kNoIndex) continue;
      border.push_back(surface.triangles[t][(k + 1) % 3]);
      border.push_back(surface.triangles[t][(k + 2) % 3]);
    }
  }
  std::sort(border.begin(), border.end());
  border.erase(std::unique(border.begin(), border.end()), border.end());
  return border;
}

struct BorderPoint {
  Vec3 place;
  std::size_t part;
  Index point;
};

bool comes_before(const BorderPoint& a, const BorderPoint& b) {
  for (const std::size_t k : {0u, 1u, 2u}) {
    if (a.place[k] != b.place[k]) return a.place[k] < b.place[k];
  }
  return a.part < b.part;
}

// Numbers of every part's points in the merged table, which is filled: common border points get one number.
std::vector<std::vector<Index>> merge_points(const std::vector<Isosurface>& parts,
                                             std::vector<Vec3>& merged) {
  std::vector<std::vector<Index>> number(parts.size());
  std::vector<BorderPoint> border;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const SurfaceMesh& surface = parts[i].surface;
    number[i].assign(surface.points.size(), kNoIndex);
    for (const Index p : border_points(surface)) border.push_back({surface.points[p], i, p});
  }
  std::sort(border.begin(), border.end(), comes_before);
  for (std::size_t b = 0; b < border.size(); ++b) {
    if (b == 0 || border[b].place != border[b - 1].place) merged.push_back(border[b].place);
    number[border[b].part][border[b].point] = static_cast<Index>(merged.size() - 1);
  }
  for (std::size_t i = 0; i < parts.size(); ++i) {
    for (std::size_t p = 0; p < number[i].size(); ++p) {
      if (number[i][p] != kNoIndex) continue;
      number[i][p] = static_cast<Index>(merged.size());
      merged.push_back(parts[i].surface.points[p]);
    }
  }
  return number;
}

}  // namespace

std::array<std::vector<CutCost>, 3> cut_costs(const Isosurface& isosurface) {
  const SurfaceMesh& surface = isosurface.surface;
  std::array<std::vector<CutCost>, 3> costs;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int32_t end = isosurface.frame.dims[axis];
    costs[axis].resize(static_cast<std::size_t>(end));
    const std::vector<std::int32_t> plane_of = planes_of_points(isosurface, axis);
    // A point lies on one plane of an axis at most, so one forest serves all planes: a curve's number of
    // points less its number of joins is 1.
    Curves curves(surface.points.size());
    for_each_cell(isosurface, [&](const CellIndex& cell, Index begin, Index stop) {
      const std::int32_t plane = cell[axis] + 1;  // from below, so that each edge on it counts once
      if (plane >= end) return;
      for (Index t = begin; t < stop; ++t) {
        for (std::size_t k = 0; k < 3; ++k) {
          const Index p = surface.triangles[t][k], q = surface.triangles[t][(k + 1) % 3];
          if (plane_of[p] != plane || plane_of[q] != plane) continue;
          if (has_side(surface, begin, stop, q, p)) continue;  // within the cell's face, not across it
          CutCost& cost = costs[axis][static_cast<std::size_t>(plane)];
          for (const Index point : {p, q}) cost.contours += curves.touch(point) ? 1 : 0;
          cost.contours -= curves.join(p, q) ? 1 : 0;
          cost.length_mm += distance(surface.points[p], surface.points[q]);
        }
      }
    });
  }
  return costs;
}

CutPlanes choose_cut(const Isosurface& isosurface, std::uint32_t pieces) {
  PERIOST_ASSERT(pieces > 0);
  const auto costs = cut_costs(isosurface);
  const double share = static_cast<double>(isosurface.surface.triangles.size()) / pieces;
  CutPlanes best;
  CutCost best_cost;
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    const auto below = triangles_below(isosurface, a);
    CutPlanes planes{axis, {}};
    CutCost cost;
    for (std::uint32_t i = 1; i < pieces; ++i) {
      const std::int32_t previous = planes.at.empty() ? 0 : planes.at.back();
      const std::int32_t plane = choose_plane(costs[a], below, i * share, 0.1 * share, previous);
      if (plane == 0) break;
      planes.at.push_back(plane);
      cost.contours += costs[a][static_cast<std::size_t>(plane)].contours;
      cost.length_mm += costs[a][static_cast<std::size_t>(plane)].length_mm;
    }
    const bool is_better = planes.at.size() != best.at.size()    ? planes.at.size() > best.at.size()
                           : cost.contours != best_cost.contours ? cost.contours < best_cost.contours
                                                                 : cost.length_mm < best_cost.length_mm;
    if (axis == 0 || is_better) {
      best = planes;
      best_cost = cost;
    }
  }
  return best;
}

Isosurface cut_part(const Isosurface& isosurface, const CutPlanes& planes, std::size_t part) {
  PERIOST_ASSERT(part <= planes.at.size());
  const auto axis = static_cast<std::size_t>(planes.axis);
  const std::int32_t begin = part == 0 ? -1 : planes.at[part - 1];
  const std::int32_t end = part == planes.at.size() ? isosurface.frame.dims[axis] : planes.at[part];
  Isosurface out;
  out.frame = isosurface.frame;
  out.is_open = true;
  out.surface.voxel_mm = isosurface.surface.voxel_mm;
  out.surface.was_read = isosurface.surface.was_read;
  out.block_table.assign(isosurface.block_table.size(), kNoIndex);
  std::vector<Triangle>& triangles = out.surface.triangles;
  for (const CellBlock& block : isosurface.blocks) {
    CellBlock kept;
    kept.first_cell = block.first_cell;
    kept.first_triangle = static_cast<Index>(triangles.size());
    for (int c = 0; c < CellBlock::kCells; ++c) {
      const auto cell = static_cast<std::size_t>(c);
      const std::int32_t index = cell_at_offset(block, c)[axis];
      if (index >= begin && index < end) {
        const auto first = isosurface.surface.triangles.begin() + block.first_triangle;
        triangles.insert(triangles.end(), first + block.first[cell], first + block.first[cell + 1]);
      }
      kept.first[cell + 1] = static_cast<std::uint16_t>(triangles.size() - kept.first_triangle);
    }
    if (kept.first.back() == 0) continue;
    const auto& at = block.first_cell;
    out.block_table[isosurface.block_entry(at[0], at[1], at[2])] = static_cast<Index>(out.blocks.size());
    out.blocks.push_back(kept);
  }
  rebuild_vertex_table(isosurface.surface.points, out.surface);
  return out;
}

Isosurface merge_isosurfaces(const std::vector<Isosurface>& parts) {
  PERIOST_ASSERT(!parts.empty());
  Isosurface out;
  out.frame = parts.front().frame;
  out.surface.voxel_mm = parts.front().surface.voxel_mm;
  out.surface.was_read = parts.front().surface.was_read;
  out.block_table.assign(parts.front().block_table.size(), kNoIndex);
  const auto number = merge_points(parts, out.surface.points);
  std::vector<Triangle>& triangles = out.surface.triangles;
  for (std::size_t entry = 0; entry < out.block_table.size(); ++entry) {
    CellBlock merged;
    merged.first_triangle = static_cast<Index>(triangles.size());
    for (std::size_t c = 0; c < CellBlock::kCells; ++c) {
      for (std::size_t i = 0; i < parts.size(); ++i) {
        if (parts[i].block_table[entry] == kNoIndex) continue;
        const CellBlock& block = parts[i].blocks[parts[i].block_table[entry]];
        merged.first_cell = block.first_cell;
        for (Index t = block.first[c]; t < block.first[c + 1]; ++t) {
          const Triangle& old = parts[i].surface.triangles[block.first_triangle + t];
          triangles.push_back({number[i][old[0]], number[i][old[1]], number[i][old[2]]});
        }
      }
      merged.first[c + 1] = static_cast<std::uint16_t>(triangles.size() - merged.first_triangle);
    }
    if (merged.first.back() == 0) continue;
    out.block_table[entry] = static_cast<Index>(out.blocks.size());
    out.blocks.push_back(merged);
  }
  out.is_open = !border_points(out.surface).empty();
  return out;
}

}  // namespace periost
