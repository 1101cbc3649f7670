#include "stages/decimate/certificate_reference.h"

#include <algorithm>
#include <limits>
#include <mutex>
#include <numeric>

#include "pipeline/base/error.h"
#include "pipeline/base/morton.h"
#include "pipeline/base/parallel.h"

namespace periost {
namespace {

constexpr std::size_t kBlock = 8192;        // triangles of one task
constexpr double kBeyondRadius = 1 + 1e-6;  // of squared radii, on the safe side of rounding

// spread_bits() of the places in a block.
constexpr std::array<std::size_t, 8> kSpread{0, 1, 8, 9, 64, 65, 72, 73};

std::array<std::int32_t, 3> cell_of(Vec3 index) {
  return {static_cast<std::int32_t>(std::floor(index.x)), static_cast<std::int32_t>(std::floor(index.y)),
          static_cast<std::int32_t>(std::floor(index.z))};
}

// Squared length of the way from a segment that begins at the origin and leads along e to the point d.
double squared_distance_to_segment(Vec3 d, Vec3 e) {
  const double along = dot(d, e), length = squared_norm(e);
  if (along <= 0) return squared_norm(d);
  return squared_norm(d - e * std::min(1.0, along / length));
}

// The numbers by ascending code, equal codes by number: blocks are sorted apart and merged in pairs.
std::vector<Index> sorted_by(const std::vector<std::uint64_t>& codes, const Context& context) {
  std::vector<std::pair<std::uint64_t, Index>> sorted(codes.size());
  for (Index i = 0; i < codes.size(); ++i) sorted[i] = {codes[i], i};
  const std::size_t half = codes.size() / 2;
  const auto at = [&](std::size_t i) { return sorted.begin() + static_cast<std::ptrdiff_t>(i); };
  parallel_for(context, 2, [&](std::size_t part) {
    part == 0 ? std::sort(at(0), at(half)) : std::sort(at(half), sorted.end());
  });
  std::inplace_merge(sorted.begin(), at(half), sorted.end());
  std::vector<Index> order;
  order.reserve(sorted.size());
  for (const auto& [code, i] : sorted) order.push_back(i);
  return order;
}

}  // namespace

double squared_distance(Vec3 p, const std::array<Vec3, 3>& t) {
  const Vec3 e1 = t[1] - t[0], e2 = t[2] - t[0], d = p - t[0];
  const Vec3 n = cross(e1, e2);
  const double nn = squared_norm(n);
  const double u = dot(cross(d, e2), n), v = dot(cross(e1, d), n), w = nn - u - v;
  const bool is_flat = !(nn > 0);
  if (!is_flat && u >= 0 && v >= 0 && w >= 0) {
    const double h = dot(d, n);
    return h * h / nn;
  }
  // The nearest point lies on an edge that the point is beyond.
  double least = std::numeric_limits<double>::infinity();
  if (is_flat || v < 0) least = squared_distance_to_segment(d, e1);
  if (is_flat || u < 0) least = std::min(least, squared_distance_to_segment(d, e2));
  if (is_flat || w < 0) least = std::min(least, squared_distance_to_segment(p - t[1], t[2] - t[1]));
  return least;
}

void link_triangles(std::vector<LinkedTriangle>& triangles, std::size_t point_count, const Context& context) {
  struct HalfEdge {
    Index to, triangle;
    std::uint8_t slot;
  };
  std::vector<Index> first(point_count + 1, 0);
  for (const auto& t : triangles) {
    for (const Index corner : t.corner) ++first[corner + 1];
  }
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<HalfEdge> out(first.back());
  auto fill = first;
  for (Index t = 0; t < triangles.size(); ++t) {
    for (std::uint8_t k = 0; k < 3; ++k) {  // the half-edge opposite to corner k
      const auto& c = triangles[t].corner;
      out[fill[c[(k + 1) % 3]]++] = {c[(k + 2) % 3], t, k};
    }
  }
  const auto find = [&](Index from, Index to) {
    const HalfEdge* found = nullptr;
    for (Index e = first[from]; e < first[from + 1]; ++e) {
      if (out[e].to != to) continue;
      if (found) {
        throw Error(
            ErrorKind::kQuality, "decimate.not_manifold",
            "the surface to decimate is not an oriented manifold: an edge has more than two triangles");
      }
      found = &out[e];
    }
    return found;
  };
  parallel_blocks(context, triangles.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      LinkedTriangle& t = triangles[i];
      for (std::size_t k = 0; k < 3; ++k) {
        find(t.corner[(k + 1) % 3], t.corner[(k + 2) % 3]);
        const HalfEdge* twin = find(t.corner[(k + 2) % 3], t.corner[(k + 1) % 3]);
        t.across[k] = twin ? twin->triangle : kNoIndex;
      }
    }
  });
}

Reference::Reference(const Isosurface& isosurface, std::vector<Index>* order, const Context& context)
    : voxel_mm(isosurface.surface.voxel_mm), frame_(isosurface.frame) {
  renumber(isosurface.surface, order, context);
  link(context);
}

void Reference::renumber(const SurfaceMesh& surface, std::vector<Index>* numbers, const Context& context) {
  const std::size_t count = surface.triangles.size();
  std::vector<std::array<std::int32_t, 3>> cell(count);
  std::array<std::int32_t, 3> lo, hi;
  lo.fill(std::numeric_limits<std::int32_t>::max());
  hi.fill(std::numeric_limits<std::int32_t>::min());
  std::mutex mutex;
  parallel_blocks(context, count, kBlock, [&](std::size_t begin, std::size_t end) {
    std::array<std::int32_t, 3> least, most;
    least.fill(std::numeric_limits<std::int32_t>::max());
    most.fill(std::numeric_limits<std::int32_t>::min());
    Vec3 overhang;
    for (std::size_t t = begin; t < end; ++t) {
      const auto& c = surface.triangles[t];
      std::array<Vec3, 3> q;
      for (std::size_t k = 0; k < 3; ++k) q[k] = frame_.to_index(surface.points[c[k]]);
      cell[t] = cell_of((q[0] + q[1] + q[2]) / 3);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        least[axis] = std::min(least[axis], cell[t][axis]);
        most[axis] = std::max(most[axis], cell[t][axis]);
        for (const Vec3& corner : q) {
          overhang[axis] =
              std::max({overhang[axis], cell[t][axis] - corner[axis], corner[axis] - cell[t][axis] - 1});
        }
      }
    }
    const std::lock_guard lock(mutex);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      lo[axis] = std::min(lo[axis], least[axis]);
      hi[axis] = std::max(hi[axis], most[axis]);
      overhang_[axis] = std::max(overhang_[axis], overhang[axis]);
    }
  });
  if (count == 0) return;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    first_cell_[axis] = lo[axis];
    block_count_[axis] = (hi[axis] - lo[axis]) / kSide + 1;
    overhang_[axis] += 1e-9;
    cells_per_mm_[axis] = 1 / frame_.spacing[axis];
  }
  std::vector<std::uint64_t> codes(count);
  for (std::size_t t = 0; t < count; ++t) {
    const auto above = [&](std::size_t axis) { return static_cast<std::uint32_t>(cell[t][axis] - lo[axis]); };
    codes[t] = morton_code(above(0), above(1), above(2));
  }
  const auto order = sorted_by(codes, context);
  // Vertices in the order in which the triangles meet them.
  std::vector<Index> number(surface.points.size(), kNoIndex);
  triangles.reserve(count);
  points.reserve(surface.points.size());
  std::vector<std::uint64_t> sorted_codes(count);
  for (std::size_t i = 0; i < count; ++i) {
    sorted_codes[i] = codes[order[i]];
    LinkedTriangle triangle{};
    for (std::size_t k = 0; k < 3; ++k) {
      const Index vertex = surface.triangles[order[i]][k];
      if (number[vertex] == kNoIndex) {
        number[vertex] = static_cast<Index>(points.size());
        points.push_back(surface.points[vertex]);
      }
      triangle.corner[k] = number[vertex];
    }
    triangles.push_back(triangle);
  }
  build_blocks(sorted_codes);
  if (numbers) *numbers = order;
}

void Reference::build_blocks(const std::vector<std::uint64_t>& codes) {
  directory_.assign(static_cast<std::size_t>(block_count_[0]) * static_cast<std::size_t>(block_count_[1]) *
                        static_cast<std::size_t>(block_count_[2]),
                    kNoIndex);
  const auto unspread = [](std::uint64_t x) {
    std::uint64_t value = 0;
    for (int bit = 0; bit < 21; ++bit) value |= (x >> (3 * bit) & 1) << bit;
    return value;
  };
  const Index count = static_cast<Index>(codes.size());
  for (Index t = 0; t < count;) {
    const std::uint64_t block_code = codes[t] / kCells;
    const std::uint64_t i = unspread(block_code), j = unspread(block_code >> 1),
                        k = unspread(block_code >> 2);
    const std::size_t place =
        i + static_cast<std::size_t>(block_count_[0]) * (j + static_cast<std::size_t>(block_count_[1]) * k);
    directory_[place] = static_cast<std::uint32_t>(block_.size());
    auto& first = block_.emplace_back();
    for (std::uint64_t cell = 0; cell < kCells; ++cell) {
      first[cell] = t;
      while (t < count && codes[t] == block_code * kCells + cell) ++t;
    }
    first[kCells] = t;
  }
}

void Reference::link(const Context& context) {
  link_triangles(triangles, points.size(), context);
  normals.resize(triangles.size());
  parallel_blocks(context, triangles.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      const auto c = corners(static_cast<Index>(t));
      normals[t] = normalized(cross(c[1] - c[0], c[2] - c[0]));
    }
  });
}

// Visits the triangles of all cells that may have one within `radius` of the point. Stops when `visit`
// returns false, and returns that.
template <class Visit>
bool Reference::visit_near(Vec3 point, double radius, Visit&& visit) const {
  constexpr std::uint32_t side = kSide;
  const Vec3 q = frame_.to_index(point);
  const double most = radius * radius * kBeyondRadius;  // squared
  const auto columns = static_cast<std::size_t>(block_count_[0]),
             rows = static_cast<std::size_t>(block_count_[1]);
  const auto [first_z, last_z] = cells_within(2, q.z, radius);
  const auto [first_y, last_y] = cells_within(1, q.y, radius);
  for (std::int32_t z = first_z; z <= last_z; ++z) {
    const auto k = static_cast<std::uint32_t>(z);
    const double left_z = most - squared_gap(2, q.z, z);
    for (std::int32_t y = first_y; y <= last_y; ++y) {
      const auto j = static_cast<std::uint32_t>(y);
      const double left = left_z - squared_gap(1, q.y, y);
      if (left < 0) continue;
      const auto [first_x, last_x] = cells_within(0, q.x, std::sqrt(left));
      const std::uint32_t* const blocks = directory_.data() + columns * (j / side + rows * (k / side));
      const std::size_t cell_yz = kSpread[j % side] << 1 | kSpread[k % side] << 2;
      for (std::int32_t x = first_x; x <= last_x; ++x) {
        const auto i = static_cast<std::uint32_t>(x);
        const std::uint32_t block = blocks[i / side];
        if (block == kNoIndex) continue;
        const Index* const first = block_[block].data() + (kSpread[i % side] | cell_yz);
        for (Index t = first[0]; t < first[1]; ++t) {
          if (!visit(t)) return false;
        }
      }
    }
  }
  return true;
}

// Cells along an axis whose triangles may come within `radius` of the coordinate q.
Reference::CellRange Reference::cells_within(std::size_t axis, double q, double radius) const {
  const double reach = radius * cells_per_mm_[axis] + overhang_[axis], at = q - first_cell_[axis];
  const double last = block_count_[axis] * kSide - 1;
  // Conversion rounds down what is not negative.
  return {static_cast<std::int32_t>(std::clamp(at - reach, 0.0, last + 1)),
          static_cast<std::int32_t>(std::clamp(at + reach, -1.0, last) + 1) - 1};
}

// Square of the least distance along an axis, mm, from the coordinate q to triangles of a cell.
double Reference::squared_gap(std::size_t axis, double q, std::int32_t cell) const {
  const double from = cell + first_cell_[axis] - overhang_[axis];
  const double gap = std::max({0.0, from - q, q - from - 1 - 2 * overhang_[axis]}) * frame_.spacing[axis];
  return gap * gap;
}

Reference::Nearest Reference::nearest(Vec3 point, double radius, Vec3 facing) const {
  Nearest best{kNoIndex, radius * radius};
  visit_near(point, radius, [&](Index t) {
    if (dot(normals[t], facing) <= 0) return true;
    const double height = dot(point - points[triangles[t].corner[0]], normals[t]);
    if (height * height > best.squared_distance) return true;
    const double d = squared_distance(point, corners(t));
    if (d < best.squared_distance || (d == best.squared_distance && t < best.triangle)) best = {t, d};
    return true;
  });
  return best;
}

// The height over the plane decides most without the distance.
bool Reference::is_near(Index triangle, Vec3 point, double squared_radius) const {
  const double height = dot(point - points[triangles[triangle].corner[0]], normals[triangle]);
  return height * height <= squared_radius * (1 + 1e-12) &&
         squared_distance(point, corners(triangle)) <= squared_radius;
}

bool Reference::has_within(Vec3 point, double radius) const {
  return !visit_near(point, radius, [&](Index t) { return !is_near(t, point, radius * radius); });
}

bool Reference::has_averted_within(Vec3 point, double radius, Vec3 facing) const {
  return !visit_near(point, radius, [&](Index t) {
    return dot(normals[t], facing) >= 0 || !is_near(t, point, radius * radius);
  });
}

void Reference::within(Vec3 point, double radius, std::vector<Index>& found) const {
  found.clear();
  visit_near(point, radius, [&](Index t) {
    if (is_near(t, point, radius * radius)) found.push_back(t);
    return true;
  });
}

}  // namespace periost
