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
constexpr double kRoundingOfVolume = 1e-13;  // of a product of three lengths
constexpr double kConeCosine = 0.5;  // normals within 60 degrees of their mean: the disk is a height field

Vec3 area_vector(const std::array<Vec3, 3>& c) {
  return cross(c[1] - c[0], c[2] - c[0]);
}

// How many corners two triangles share; with exactly one, where it stands in each.
std::size_t shared_corners(const std::array<Index, 3>& a, const std::array<Index, 3>& b, std::size_t& in_a,
                           std::size_t& in_b) {
  const auto is_in = [](Index v, const std::array<Index, 3>& t) {
    return static_cast<std::size_t>(v == t[0]) | static_cast<std::size_t>(v == t[1]) |
           static_cast<std::size_t>(v == t[2]);
  };
  const std::size_t second = is_in(a[1], b), third = is_in(a[2], b), count = is_in(a[0], b) + second + third;
  if (count != 1) return count;
  in_a = second + 2 * third;
  in_b = is_in(b[1], a) + 2 * is_in(b[2], a);
  return count;
}

std::uint64_t marks_of(const std::array<Index, 3>& corner) {
  return mark_of(corner[0]) | mark_of(corner[1]) | mark_of(corner[2]);
}

Facet facet_of(const LinkedTriangle& t, const std::array<Vec3, 3>& c) {
  return {c, area_vector(c),
          std::max({squared_norm(c[1] - c[0]), squared_norm(c[2] - c[1]), squared_norm(c[0] - c[2])}),
          marks_of(t.corner)};
}

// Whether two points lie on the same side of a triangle's plane, further from it than rounding may matter.
bool are_beside(const Facet& t, Vec3 p, Vec3 q) {
  const Vec3 to_p = p - t.corner[0], to_q = q - t.corner[0];
  const double reach = std::abs(to_p.x) + std::abs(to_p.y) + std::abs(to_p.z) + std::abs(to_q.x) +
                       std::abs(to_q.y) + std::abs(to_q.z);
  const double least = kRoundingOfVolume * t.squared_size * reach;
  const double volume_p = dot(t.area, to_p), volume_q = dot(t.area, to_q);
  return std::min(volume_p, volume_q) > least || std::max(volume_p, volume_q) < -least;
}

// Whether two triangles with one common corner meet elsewhere: then the edge opposite to it does, in one. Not
// where one lies on one side of the other's plane but for that corner.
bool meet_beyond_corner(const Facet& a, std::size_t i, const Facet& b, std::size_t j) {
  const Vec3 a1 = a.corner[(i + 1) % 3], a2 = a.corner[(i + 2) % 3];
  const Vec3 b1 = b.corner[(j + 1) % 3], b2 = b.corner[(j + 2) % 3];
  if (are_beside(b, a1, a2) || are_beside(a, b1, b2)) return false;
  return segment_meets_triangle(a1, a2, b.corner) || segment_meets_triangle(b1, b2, a.corner);
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

// The new triangles, and what their normals lie around.
struct NewTriangles {
  const Proposal& proposal;
  const std::vector<Facet>& facet;
  Vec3 axis;
};

NewTriangles new_triangles(const CertifiedMesh& mesh, const Proposal& proposal, SheetScratch& scratch) {
  scratch.facet.clear();
  Vec3 axis;
  for (const LinkedTriangle& cell : proposal.cells) {
    scratch.facet.push_back(facet_of(cell, corners_after(mesh, proposal, cell)));
    axis += scratch.facet.back().area;
  }
  return {proposal, scratch.facet, axis};
}

// Whether the normals of the new triangles, and of those around them, lie in one narrow cone about the
// ring's.
struct HeightField {
  bool ring = true, around = true;
};
HeightField height_field(const CertifiedMesh& mesh, const NewTriangles& fresh,
                         const std::vector<Index>& around) {
  const double limit = kConeCosine * kConeCosine * squared_norm(fresh.axis);
  const auto is_inside = [&](Vec3 area) {
    const double product = dot(fresh.axis, area);
    return product > 0 && product * product > limit * squared_norm(area);
  };
  return {
      std::all_of(fresh.facet.begin(), fresh.facet.end(), [&](const Facet& f) { return is_inside(f.area); }),
      std::all_of(around.begin(), around.end(),
                  [&](Index t) { return is_inside(area_vector(corners_now(mesh, t))); })};
}

// New triangles against one another, where they share one corner.
bool meet_each_other(const NewTriangles& fresh) {
  std::size_t p = 0, q = 0;
  for (std::size_t i = 0; i < fresh.facet.size(); ++i) {
    const auto& ids = fresh.proposal.cells[i].corner;
    for (std::size_t j = i + 1; j < fresh.facet.size(); ++j) {
      if (shared_corners(ids, fresh.proposal.cells[j].corner, p, q) == 1 &&
          meet_beyond_corner(fresh.facet[i], p, fresh.facet[j], q)) {
        return true;
      }
    }
  }
  return false;
}

// New triangles against those around them that they share one corner with.
bool meet_around(const CertifiedMesh& mesh, const NewTriangles& fresh, const std::vector<Index>& around) {
  std::size_t p = 0, q = 0;
  for (const Index t : around) {
    const auto& ids = mesh.triangles[t].corner;
    const Facet facet = facet_of(mesh.triangles[t], corners_now(mesh, t));
    for (std::size_t i = 0; i < fresh.facet.size(); ++i) {
      if ((fresh.facet[i].marks & facet.marks) == 0) continue;
      if (shared_corners(fresh.proposal.cells[i].corner, ids, p, q) == 1 &&
          meet_beyond_corner(fresh.facet[i], p, facet, q)) {
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
  scratch.is_watched = false;
  const auto [first, last] = range_of(scratch.grid_box);
  for (std::int32_t k = first[2]; k <= last[2]; ++k) {
    for (std::int32_t j = first[1]; j <= last[1]; ++j) {
      const std::size_t row = row_of(j, k);
      for (std::size_t i = row + static_cast<std::size_t>(first[0]);
           i <= row + static_cast<std::size_t>(last[0]); ++i) {
        if (!is_watched_[i]) continue;
        scratch.is_watched = true;
        __builtin_prefetch(cells_[i].data());
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

void SheetGrid::insert(const CertifiedMesh& mesh, const Proposal& proposal, const SheetScratch& scratch) {
  if (!scratch.is_watched) return;
  for (const Index t : proposal.after) insert(mesh, t);
}

// All new triangles are looked at together, so that what is near them is fetched once.
bool SheetGrid::meets_sheets(const CertifiedMesh& mesh, const Proposal& proposal, SheetScratch& scratch) {
  if (scratch.stamp.size() < mesh.triangles.size()) scratch.stamp.resize(mesh.triangles.size(), 0);
  const std::uint32_t tick = ++scratch.tick;
  scratch.box.clear();
  Box all;
  for (std::size_t i = 0; i < proposal.cells.size(); ++i) {
    scratch.box.push_back(box_of(scratch.facet[i].corner));
    all.add(scratch.box.back());
  }
  const auto is_clear_of = [&](Index t) {
    const auto b = corners_now(mesh, t);
    const Box box = box_of(b);
    if (!box.meets(all) || proposal.before.contains(t)) return true;
    for (std::size_t i = 0; i < proposal.cells.size(); ++i) {
      if (!box.meets(scratch.box[i])) continue;
      const auto& ids = mesh.triangles[t].corner;
      std::size_t p = 0, q = 0;
      if ((scratch.facet[i].marks & marks_of(ids)) != 0 &&
          shared_corners(proposal.cells[i].corner, ids, p, q) > 0) {
        continue;
      }
      if (triangles_meet(scratch.facet[i].corner, b)) return false;
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
  const NewTriangles fresh = new_triangles(mesh, proposal, scratch);
  // A disc with a contour in it can lie on itself though all its normals are alike.
  const bool is_open =
      std::any_of(proposal.rim.begin(), proposal.rim.end(), [&](Index v) { return mesh.is_on_contour(v); });
  const HeightField is = is_open ? HeightField{false, false} : height_field(mesh, fresh, around);
  if (!is.ring && meet_each_other(fresh)) return true;
  if (!(is.ring && is.around) && meet_around(mesh, fresh, around)) return true;
  return scratch.is_watched && meets_sheets(mesh, proposal, scratch);
}

}  // namespace periost
