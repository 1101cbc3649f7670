#include "stages/decimate/certified_sheets.h"

#include <algorithm>
#include <limits>

#include "pipeline/geometry/predicates.h"

namespace periost {
namespace {

constexpr std::size_t kMostCells = std::size_t{1} << 22;
constexpr double kConeCosine = 0.5;  // normals within 60 degrees of their mean: the disk is a height field

Vec3 normal_of(const std::array<Vec3, 3>& c) {
  return normalized(cross(c[1] - c[0], c[2] - c[0]));
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
  for (const Vec3& point : c) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      box.lo[axis] = std::min(box.lo[axis], point[axis]);
      box.hi[axis] = std::max(box.hi[axis], point[axis]);
    }
  }
  return box;
}

// Whether all normals of the ring and around it lie in one narrow cone.
bool is_height_field(const CertifiedMesh& mesh, const Proposal& proposal, const std::vector<Index>& around) {
  Vec3 sum;
  for (std::size_t i = 0; i < proposal.after.size(); ++i)
    sum += normal_of(corners_after(mesh, proposal, proposal.cells[i]));
  const double limit = kConeCosine * norm(sum);
  for (std::size_t i = 0; i < proposal.after.size(); ++i) {
    if (dot(sum, normal_of(corners_after(mesh, proposal, proposal.cells[i]))) <= limit) return false;
  }
  return std::all_of(around.begin(), around.end(),
                     [&](Index t) { return dot(sum, normal_of(corners_now(mesh, t))) > limit; });
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

SheetGrid::SheetGrid(const Reference& reference, const CertifiedMesh& mesh, int side_voxels)
    : frame_(reference.frame()), side_(side_voxels) {
  Vec3 lo{1e300, 1e300, 1e300}, hi{-1e300, -1e300, -1e300};
  for (const Vec3& point : mesh.points) {
    const Vec3 q = frame_.to_index(point);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      lo[axis] = std::min(lo[axis], q[axis]);
      hi[axis] = std::max(hi[axis], q[axis]);
    }
  }
  const auto count_cells = [&] {
    std::size_t cells = 1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      first_[axis] = static_cast<std::int32_t>(std::floor(lo[axis] / side_)) - 1;
      count_[axis] = static_cast<std::int32_t>(std::floor(hi[axis] / side_)) - first_[axis] + 2;
      cells *= static_cast<std::size_t>(count_[axis]);
    }
    return cells;
  };
  if (mesh.points.empty()) return;
  while (count_cells() > kMostCells) side_ *= 2;
  cells_.resize(count_cells());
  refill(mesh);
}

void SheetGrid::refill(const CertifiedMesh& mesh) {
  for (auto& cell : cells_) cell.clear();
  for (Index t = 0; t < mesh.triangles.size(); ++t) {
    if (mesh.triangles[t].is_alive()) insert(t, corners_now(mesh, t));
  }
}

SheetGrid::Range SheetGrid::range_of(const Vec3* begin, const Vec3* end) const {
  Vec3 lo{1e300, 1e300, 1e300}, hi{-1e300, -1e300, -1e300};
  for (const Vec3* point = begin; point != end; ++point) {
    const Vec3 q = frame_.to_index(*point);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      lo[axis] = std::min(lo[axis], q[axis]);
      hi[axis] = std::max(hi[axis], q[axis]);
    }
  }
  Range range{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto cell = [&](double x) {
      return std::clamp(static_cast<std::int32_t>(std::floor(x / side_)) - first_[axis], 0, count_[axis] - 1);
    };
    range.lo[axis] = cell(lo[axis] - 1e-6);
    range.hi[axis] = cell(hi[axis] + 1e-6);
  }
  return range;
}

void SheetGrid::insert(Index triangle, const std::array<Vec3, 3>& corners) {
  for_cells(range_of(corners.data(), corners.data() + 3), [&](std::vector<Index>& list) {
    if (std::find(list.begin(), list.end(), triangle) == list.end()) list.push_back(triangle);
    return true;
  });
}

void SheetGrid::insert(const CertifiedMesh& mesh, const Proposal& proposal) {
  for (const Index t : proposal.after) insert(t, corners_now(mesh, t));
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
  const auto is_clear = [&](std::vector<Index>& list) {
    std::size_t dead = 0;
    for (const Index t : list) {
      if (!mesh.triangles[t].is_alive()) {
        ++dead;
      } else if (scratch.stamp[t] != tick) {
        scratch.stamp[t] = tick;
        if (!is_clear_of(t)) return false;
      }
    }
    if (dead > 0) std::erase_if(list, [&](Index t) { return !mesh.triangles[t].is_alive(); });
    return true;
  };
  return !for_cells(range_of(scratch.corner.data(), scratch.corner.data() + scratch.corner.size()), is_clear);
}

bool SheetGrid::would_intersect(const CertifiedMesh& mesh, const Proposal& proposal,
                                const std::vector<Index>& around, SheetScratch& scratch) {
  if (!is_height_field(mesh, proposal, around) && meets_neighbours(mesh, proposal, around)) return true;
  return meets_sheets(mesh, proposal, scratch);
}

}  // namespace periost
