#include "stages/decimate/certified_sheets.h"

#include <algorithm>
#include <limits>

#include "pipeline/geometry/predicates.h"

namespace periost {
namespace {

constexpr std::size_t kMostCells = std::size_t{1} << 22;
constexpr double kConeCosine = 0.5;  // normals within 60 degrees of their mean: the disk is a height field

std::array<Vec3, 3> corners_after(const CertifiedMesh& mesh, const Proposal& proposal, std::size_t i) {
  const auto& c = proposal.cells[i].corner;
  return {proposal.point_of(mesh, c[0]), proposal.point_of(mesh, c[1]), proposal.point_of(mesh, c[2])};
}

std::array<Vec3, 3> corners_now(const CertifiedMesh& mesh, Index t) {
  const auto& c = mesh.triangles[t].corner;
  return {mesh.points[c[0]], mesh.points[c[1]], mesh.points[c[2]]};
}

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

// Whether all normals of the ring and around it lie in one narrow cone.
bool is_height_field(const CertifiedMesh& mesh, const Proposal& proposal, const std::vector<Index>& around) {
  Vec3 sum;
  for (std::size_t i = 0; i < proposal.after.size(); ++i) sum += normal_of(corners_after(mesh, proposal, i));
  const double limit = kConeCosine * norm(sum);
  for (std::size_t i = 0; i < proposal.after.size(); ++i) {
    if (dot(sum, normal_of(corners_after(mesh, proposal, i))) <= limit) return false;
  }
  return std::all_of(around.begin(), around.end(),
                     [&](Index t) { return dot(sum, normal_of(corners_now(mesh, t))) > limit; });
}

// New triangles against those that they share one corner with.
bool meets_neighbours(const CertifiedMesh& mesh, const Proposal& proposal, const std::vector<Index>& around) {
  std::size_t p = 0, q = 0;
  for (std::size_t i = 0; i < proposal.after.size(); ++i) {
    const auto a = corners_after(mesh, proposal, i);
    const auto& ids = proposal.cells[i].corner;
    for (std::size_t j = i + 1; j < proposal.after.size(); ++j) {
      if (shared_corners(ids, proposal.cells[j].corner, p, q) == 1 &&
          meet_beyond_corner(a, p, corners_after(mesh, proposal, j), q)) {
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

SheetGrid::Range SheetGrid::range_of(const std::array<Vec3, 3>& corners) const {
  Range range{};
  std::array<Vec3, 3> q;
  for (std::size_t k = 0; k < 3; ++k) q[k] = frame_.to_index(corners[k]);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double lo = std::min({q[0][axis], q[1][axis], q[2][axis]}) - 1e-6;
    const double hi = std::max({q[0][axis], q[1][axis], q[2][axis]}) + 1e-6;
    const auto cell = [&](double x) {
      return std::clamp(static_cast<std::int32_t>(std::floor(x / side_)) - first_[axis], 0, count_[axis] - 1);
    };
    range.lo[axis] = cell(lo);
    range.hi[axis] = cell(hi);
  }
  return range;
}

void SheetGrid::insert(Index triangle, const std::array<Vec3, 3>& corners) {
  for_cells(range_of(corners), [&](std::vector<Index>& list) {
    if (std::find(list.begin(), list.end(), triangle) == list.end()) list.push_back(triangle);
    return true;
  });
}

void SheetGrid::insert(const CertifiedMesh& mesh, const Proposal& proposal) {
  for (const Index t : proposal.after) insert(t, corners_now(mesh, t));
}

bool SheetGrid::meets_sheets(const CertifiedMesh& mesh, const Proposal& proposal, SheetScratch& scratch) {
  if (scratch.stamp.size() < mesh.triangles.size()) scratch.stamp.resize(mesh.triangles.size(), 0);
  for (std::size_t i = 0; i < proposal.after.size(); ++i) {
    const auto a = corners_after(mesh, proposal, i);
    Vec3 lo = a[0], hi = a[0];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      lo[axis] = std::min({a[0][axis], a[1][axis], a[2][axis]});
      hi[axis] = std::max({a[0][axis], a[1][axis], a[2][axis]});
    }
    const std::uint32_t tick = ++scratch.tick;
    const auto is_clear_of = [&](Index t) {
      if (scratch.stamp[t] == tick) return true;
      scratch.stamp[t] = tick;
      const LinkedTriangle& other = mesh.triangles[t];
      if (!other.is_alive() || proposal.before.contains(t)) return true;
      const auto b = corners_now(mesh, t);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (std::min({b[0][axis], b[1][axis], b[2][axis]}) > hi[axis] ||
            std::max({b[0][axis], b[1][axis], b[2][axis]}) < lo[axis]) {
          return true;
        }
      }
      std::size_t p = 0, q = 0;
      return shared_corners(proposal.cells[i].corner, other.corner, p, q) > 0 || !triangles_meet(a, b);
    };
    const bool is_clear = for_cells(range_of(a), [&](std::vector<Index>& list) {
      std::erase_if(list, [&](Index t) { return !mesh.triangles[t].is_alive(); });
      return std::all_of(list.begin(), list.end(), is_clear_of);
    });
    if (!is_clear) return true;
  }
  return false;
}

bool SheetGrid::would_intersect(const CertifiedMesh& mesh, const Proposal& proposal,
                                const std::vector<Index>& around, SheetScratch& scratch) {
  if (!is_height_field(mesh, proposal, around) && meets_neighbours(mesh, proposal, around)) return true;
  return meets_sheets(mesh, proposal, scratch);
}

}  // namespace periost
