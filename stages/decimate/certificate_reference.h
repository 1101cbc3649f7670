#pragma once
// The isosurface as the certificates read it: triangles linked across their edges and renumbered along a
// Morton curve of the image's cells, so that the triangles of one cell are contiguous and near ones are near
// in memory. Immutable once built; safe to read from many threads.
#include <array>
#include <cstdint>
#include <vector>

#include "pipeline/base/context.h"
#include "pipeline/data/isosurface.h"

namespace periost {

// A triangle and its three neighbours: across[k] lies over the edge opposite to corner[k], kNoIndex on a
// contour. Corners run counter-clockwise seen from outside.
struct LinkedTriangle {
  std::array<Index, 3> corner;
  std::array<Index, 3> across;

  bool is_alive() const { return corner[0] != kNoIndex; }
  // Position of a vertex among the corners. Precondition: it is one of them.
  std::size_t slot_of(Index vertex) const {
    return static_cast<std::size_t>(corner[1] == vertex) + 2 * static_cast<std::size_t>(corner[2] == vertex);
  }
  bool has(Index vertex) const { return corner[0] == vertex || corner[1] == vertex || corner[2] == vertex; }
};

class Reference {
 public:
  // Preconditions: the surface is an oriented manifold without isolated points or degenerate triangles;
  // frame.spacing is positive. O(n log n). Throws Error{kQuality} when an edge has more than two triangles.
  // `order`, when given, receives the isosurface's own number of each triangle. On all threads of the
  // context.
  explicit Reference(const Isosurface& isosurface, std::vector<Index>* order = nullptr,
                     const Context& context = {});

  std::vector<Vec3> points;               // LPS mm, Morton order
  std::vector<LinkedTriangle> triangles;  // sorted by cell
  std::vector<Vec3> normals;              // unit, of triangles
  double voxel_mm = 0;                    // largest voxel side; 0: no image behind it

  struct Nearest {
    Index triangle = kNoIndex;
    double squared_distance = 0;
  };
  // The nearest triangle whose normal has a positive product with `facing`, among those within `radius`;
  // kNoIndex when there is none. Equal distances: the smallest index.
  Nearest nearest(Vec3 point, double radius, Vec3 facing) const;

  // Replaces `found` by all triangles within `radius` of the point, in ascending order of cells.
  void within(Vec3 point, double radius, std::vector<Index>& found) const;
  // Whether there is any.
  bool has_within(Vec3 point, double radius) const;
  // Whether there is any whose normal's product with `facing` is negative.
  bool has_averted_within(Vec3 point, double radius, Vec3 facing) const;

  std::array<Vec3, 3> corners(Index triangle) const {
    const auto& c = triangles[triangle].corner;
    return {points[c[0]], points[c[1]], points[c[2]]};
  }
  const GridFrame& frame() const { return frame_; }

 private:
  static constexpr int kSide = 8;
  static constexpr int kCells = kSide * kSide * kSide;
  struct CellRange {
    std::int32_t first, last;  // inclusive
  };

  void renumber(const SurfaceMesh& surface, std::vector<Index>* numbers, const Context& context);
  void link(const Context& context);
  void build_blocks(const std::vector<std::uint64_t>& codes);
  CellRange cells_within(std::size_t axis, double q, double radius) const;
  double squared_gap(std::size_t axis, double q, std::int32_t cell) const;
  bool is_near(Index triangle, Vec3 point, double squared_radius) const;
  template <class Visit>
  bool visit_near(Vec3 point, double radius, Visit&& visit) const;

  GridFrame frame_;
  std::array<std::int32_t, 3> first_cell_{};   // smallest cell index, a multiple of kSide
  std::array<std::int32_t, 3> block_count_{};  // extent of the directory
  Vec3 cells_per_mm_;
  Vec3 overhang_;                                     // how far triangles leave the cell of their centroid
  std::vector<std::uint32_t> directory_;              // block at (i, j, k), or kNoIndex
  std::vector<std::array<Index, kCells + 1>> block_;  // first triangle of each cell, in Morton order
};

// Links triangles across their edges. Throws Error{kQuality} when an edge has more than two triangles or two
// triangles run along it in the same direction.
void link_triangles(std::vector<LinkedTriangle>& triangles, std::size_t point_count,
                    const Context& context = {});

// Squared distance from a point to a closed triangle; exact up to rounding.
double squared_distance(Vec3 point, const std::array<Vec3, 3>& triangle);

}  // namespace periost
