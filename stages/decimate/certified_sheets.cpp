#include "stages/decimate/certified_sheets.h"

#include <algorithm>
#include <limits>

#include "pipeline/base/parallel.h"
#include "pipeline/geometry/predicates.h"

namespace periost {
namespace {

constexpr std::size_t kMostCells = std::size_t{1} << 22;
constexpr double kBeyondCell = 1e-6;  // cells; boxes are taken larger by this
constexpr std::uint32_t kByteTops = 0x808080;
constexpr double kConeCosine = 0.5;  // normals within 60 degrees of their mean: the disk is a height field

Vec3 area_vector(const std::array<Vec3, 3>& c) {
  return cross(c[1] - c[0], c[2] - c[0]);
}

// How many corners two triangles share; with exactly one, where it stands in each.
int shared_corners(const std::array<Index, 3>& a, const std::array<Index, 3>& b, std::size_t& in_a,
                   std::size_t& in_b) {
  int count = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      if (a[i] != b[j]) continue;
      ++count;
      in_a = i;
      in_b = j;
    }
  }
  return count;
}

// Whether two triangles with one common corner meet elsewhere: then the edge opposite to it does, in one.
bool meet_beyond_corner(const std::array<Vec3, 3>& a, std::size_t i, const std::array<Vec3, 3>& b,
                        std::size_t j) {
  return segment_meets_triangle(a[(i + 1) % 3], a[(i + 2) % 3], b) ||
         segment_meets_triangle(b[(j + 1) % 3], b[(j + 2) % 3], a);
}

Box box_of(const std::array<Vec3, 3>& c) {
  Box box;
  for (const Vec3& point : c) box.add(point);
  return box;
}

// Where x lies in a cell that begins at `cell`, in 127ths; rounded down or up.
std::uint32_t part_below(double x, std::int32_t cell) {
  return static_cast<std::uint32_t>(std::clamp((x - cell) * 127, 0.0, 127.0));
}
std::uint32_t part_above(double x, std::int32_t cell) {
  return 127 - static_cast<std::uint32_t>(std::clamp((cell + 1 - x) * 127, 0.0, 127.0));
}

// Whether two boxes of bytes below 128 meet in all three axes.
bool bytes_meet(std::uint32_t lo1, std::uint32_t hi1, std::uint32_t lo2, std::uint32_t hi2) {
  return (((hi1 | kByteTops) - lo2) & ((hi2 | kByteTops) - lo1) & kByteTops) == kByteTops;
}

// Whether all normals of the ring and around it lie in one narrow cone about the ring's own.
bool is_height_field(const CertifiedMesh& mesh, const Proposal& proposal, const std::vector<Index>& around) {
  Vec3 axis;
  for (const LinkedTriangle& cell : proposal.cells) {
    axis += area_vector(corners_after(mesh, proposal, cell));
  }
  const double limit = kConeCosine * kConeCosine * squared_norm(axis);
  const auto is_inside = [&](Vec3 area) {
    const double product = dot(axis, area);
    return product > 0 && product * product > limit * squared_norm(area);
  };
  return std::all_of(proposal.cells.begin(), proposal.cells.end(),
                     [&](const LinkedTriangle& cell) {
                       return is_inside(area_vector(corners_after(mesh, proposal, cell)));
                     }) &&
         std::all_of(around.begin(), around.end(),
                     [&](Index t) { return is_inside(area_vector(corners_now(mesh, t))); });
}

// New triangles against those that they share one corner with.
bool meets_neighbours(const CertifiedMesh& mesh, const Proposal& proposal, const std::vector<Index>& around) {
  std::size_t p = 0, q = 0;
  for (std::size_t i = 0; i < proposal.after.size(); ++i) {
    const auto a = corners_after(mesh, proposal, proposal.cells[i]);
    const auto& ids = proposal.cells[i].corner;
    for (std::size_t j = i + 1; j < proposal.after.size(); ++j) {
      if (shared_corners(ids, proposal.cells[j].corner, p, q) == 1 &&
          meet_beyond_corner(a, p, corners_after(mesh, proposal, proposal.cells[j]), q)) {
        return true;
      }
    }
    for (const Index t : around) {
      if (shared_corners(ids, mesh.triangles[t].corner, p, q) == 1 &&
          meet_beyond_corner(a, p, corners_now(mesh, t), q)) {
        return true;
      }
    }
  }
  return false;
}

}  // namespace

std::vector<Index> close_sheets(const Reference& reference, double gap, const Context& context) {
  constexpr std::size_t kBlock = 4096;
  std::vector<std::uint8_t> is_close(reference.triangles.size(), 0);
  parallel_blocks(context, is_close.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      const auto c = reference.corners(static_cast<Index>(t));
      const Vec3 centroid = (c[0] + c[1] + c[2]) / 3;
      const double radius = std::sqrt(std::max(
          {squared_norm(c[0] - centroid), squared_norm(c[1] - centroid), squared_norm(c[2] - centroid)}));
      is_close[t] = reference.has_averted_within(centroid, radius + gap, reference.normals[t]) ? 1 : 0;
    }
  });
  std::vector<Index> close;
  for (Index t = 0; t < is_close.size(); ++t) {
    if (is_close[t]) close.push_back(t);
  }
  return close;
}

SheetGrid::SheetGrid(const Reference& reference, const CertifiedMesh& mesh, int side_voxels)
    : side_(side_voxels) {
  lay_out(reference, mesh);
  is_watched_.assign(cells_.size(), 1);
  fill(mesh);
}

SheetGrid::SheetGrid(const Reference& reference, const CertifiedMesh& mesh, int side_voxels,
                     const std::vector<Index>& close, double reach)
    : side_(side_voxels) {
  lay_out(reference, mesh);
  is_watched_.assign(cells_.size(), 0);
  Vec3 margin;
  for (std::size_t axis = 0; axis < 3; ++axis) margin[axis] = reach * norm(row_[axis]);
  for (const Index t : close) {
    Box box;
    for (const Vec3& corner : reference.corners(t)) box.add(to_grid(corner));
    watch({box.lo - margin, box.hi + margin});
  }
  fill(mesh);
}

void SheetGrid::lay_out(const Reference& reference, const CertifiedMesh& mesh) {
  if (mesh.points.empty()) return;
  while (choose_cells(mesh, reference.frame()) > kMostCells) side_ *= 2;
  cells_.resize(choose_cells(mesh, reference.frame()));
}

void SheetGrid::watch(const Box& box) {
  const auto [first, last] = range_of(box);
  for (std::int32_t k = first[2]; k <= last[2]; ++k) {
    for (std::int32_t j = first[1]; j <= last[1]; ++j) {
      for (std::int32_t i = first[0]; i <= last[0]; ++i) {
        is_watched_[row_of(j, k) + static_cast<std::size_t>(i)] = 1;
      }
    }
  }
}

// Sets the map and the extent for cells of the present side; how many there would be.
std::size_t SheetGrid::choose_cells(const CertifiedMesh& mesh, const GridFrame& frame) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    row_[axis] = frame.direction.column[axis] / (frame.spacing[axis] * side_);
    shift_[axis] = -dot(row_[axis], frame.origin);
  }
  Box box;
  for (const Vec3& point : mesh.points) box.add(to_grid(point));
  std::size_t cells = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double first = std::floor(box.lo[axis]) - 1;
    shift_[axis] -= first;
    count_[axis] = static_cast<std::int32_t>(std::floor(box.hi[axis]) - first) + 2;
    cells *= static_cast<std::size_t>(count_[axis]);
  }
  return cells;
}

void SheetGrid::fill(const CertifiedMesh& mesh) {
  for (Index t = 0; t < mesh.triangles.size(); ++t) {
    if (mesh.triangles[t].is_alive()) insert(mesh, t);
  }
}

void SheetGrid::purge(const CertifiedMesh& mesh, const Context& context) {
  constexpr std::size_t kBlock = 2048;
  parallel_blocks(context, cells_.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t cell = begin; cell < end; ++cell) {
      std::erase_if(cells_[cell], [&](const Entry& entry) {
        if (!mesh.triangles[entry.triangle].is_alive()) return true;
        const auto [first, last] = range_of(box_in_cells(mesh, entry.triangle));
        std::size_t row = cell;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const auto count = static_cast<std::size_t>(count_[axis]);
          const auto place = static_cast<std::int32_t>(row % count);
          if (place < first[axis] || place > last[axis]) return true;
          row /= count;
        }
        return false;
      });
    }
  });
}

Box SheetGrid::box_in_cells(const CertifiedMesh& mesh, Index triangle) const {
  Box box;
  for (const Vec3& corner : corners_now(mesh, triangle)) box.add(to_grid(corner));
  return box;
}

SheetGrid::Range SheetGrid::range_of(const Box& box) const {
  Range range{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto cell = [&](double x) { return std::clamp(static_cast<std::int32_t>(x), 0, count_[axis] - 1); };
    range.first[axis] = cell(box.lo[axis] - kBeyondCell);
    range.last[axis] = cell(box.hi[axis] + kBeyondCell);
  }
  return range;
}

// Visits the watched cells that a box meets, with the part of each that it takes, until `visit` returns
// false; whether none did.
template <class Visit>
bool SheetGrid::for_cells(const Box& box, Visit&& visit) {
  const auto [first, last] = range_of(box);
  for (std::int32_t k = first[2]; k <= last[2]; ++k) {
    const std::uint32_t lo_z = part_below(box.lo.z - kBeyondCell, k) << 16;
    const std::uint32_t hi_z = part_above(box.hi.z + kBeyondCell, k) << 16;
    for (std::int32_t j = first[1]; j <= last[1]; ++j) {
      const std::uint32_t lo_yz = part_below(box.lo.y - kBeyondCell, j) << 8 | lo_z;
      const std::uint32_t hi_yz = part_above(box.hi.y + kBeyondCell, j) << 8 | hi_z;
      const std::size_t row = row_of(j, k);
      for (std::int32_t i = first[0]; i <= last[0]; ++i) {
        const std::size_t cell = row + static_cast<std::size_t>(i);
        if (!is_watched_[cell]) continue;
        const std::uint32_t lo = part_below(box.lo.x - kBeyondCell, i) | lo_yz;
        const std::uint32_t hi = part_above(box.hi.x + kBeyondCell, i) | hi_yz;
        if (!visit(cells_[cell], lo, hi)) return false;
      }
    }
  }
  return true;
}

void SheetGrid::approach(const CertifiedMesh& mesh, const Proposal& proposal, SheetScratch& scratch) const {
  scratch.grid_box = {};
  for (const Index v : proposal.rim) scratch.grid_box.add(to_grid(mesh.points[v]));
  if (proposal.moved != kNoIndex) scratch.grid_box.add(to_grid(proposal.place));
  const auto [first, last] = range_of(scratch.grid_box);
  for (std::int32_t k = first[2]; k <= last[2]; ++k) {
    for (std::int32_t j = first[1]; j <= last[1]; ++j) {
      const std::size_t row = row_of(j, k);
      for (std::size_t i = row + static_cast<std::size_t>(first[0]);
           i <= row + static_cast<std::size_t>(last[0]); ++i) {
        if (is_watched_[i]) __builtin_prefetch(cells_[i].data());
      }
    }
  }
}

void SheetGrid::insert(const CertifiedMesh& mesh, Index triangle) {
  for_cells(box_in_cells(mesh, triangle), [&](std::vector<Entry>& list, std::uint32_t lo, std::uint32_t hi) {
    const auto same = [&](const Entry& entry) { return entry.triangle == triangle; };
    const auto found = std::find_if(list.begin(), list.end(), same);
    if (found == list.end()) {
      list.push_back({triangle, lo, hi});
    } else {
      *found = {triangle, lo, hi};
    }
    return true;
  });
}

void SheetGrid::insert(const CertifiedMesh& mesh, const Proposal& proposal) {
  for (const Index t : proposal.after) insert(mesh, t);
}

// All new triangles are looked at together, so that what is near them is fetched once.
bool SheetGrid::meets_sheets(const CertifiedMesh& mesh, const Proposal& proposal, SheetScratch& scratch) {
  if (scratch.stamp.size() < mesh.triangles.size()) scratch.stamp.resize(mesh.triangles.size(), 0);
  const std::uint32_t tick = ++scratch.tick;
  scratch.corner.clear();
  scratch.box.clear();
  Box all;
  for (const LinkedTriangle& cell : proposal.cells) {
    const auto corners = corners_after(mesh, proposal, cell);
    scratch.corner.insert(scratch.corner.end(), corners.begin(), corners.end());
    scratch.box.push_back(box_of(corners));
    all.add(scratch.box.back());
  }
  const auto is_clear_of = [&](Index t) {
    const auto b = corners_now(mesh, t);
    const Box box = box_of(b);
    if (!box.meets(all) || proposal.before.contains(t)) return true;
    for (std::size_t i = 0; i < proposal.cells.size(); ++i) {
      if (!box.meets(scratch.box[i])) continue;
      std::size_t p = 0, q = 0;
      if (shared_corners(proposal.cells[i].corner, mesh.triangles[t].corner, p, q) > 0) continue;
      const Vec3* a = scratch.corner.data() + 3 * i;
      if (triangles_meet({a[0], a[1], a[2]}, b)) return false;
    }
    return true;
  };
  const auto is_clear = [&](std::vector<Entry>& list, std::uint32_t lo, std::uint32_t hi) {
    for (std::size_t i = 0; i < list.size();) {
      const Entry& entry = list[i];
      if (!bytes_meet(entry.lo, entry.hi, lo, hi)) {
        ++i;
      } else if (!mesh.triangles[entry.triangle].is_alive()) {
        list[i] = list.back();
        list.pop_back();
      } else {
        if (scratch.stamp[entry.triangle] != tick) {
          scratch.stamp[entry.triangle] = tick;
          if (!is_clear_of(entry.triangle)) return false;
        }
        ++i;
      }
    }
    return true;
  };
  return !for_cells(scratch.grid_box, is_clear);
}

bool SheetGrid::would_intersect(const CertifiedMesh& mesh, const Proposal& proposal,
                                const std::vector<Index>& around, SheetScratch& scratch) {
  // A disc with a contour in it can lie on itself though all its normals are alike.
  const bool is_open =
      std::any_of(proposal.rim.begin(), proposal.rim.end(), [&](Index v) { return mesh.is_on_contour(v); });
  if ((is_open || !is_height_field(mesh, proposal, around)) && meets_neighbours(mesh, proposal, around))
    return true;
  return meets_sheets(mesh, proposal, scratch);
}

}  // namespace periost
