#pragma once
// The new triangles of a ring in a plane: the frame in which certificate_ring.h lays the isosurface over
// them.
#include <array>
#include <cstddef>
#include <cstdint>

#include "stages/decimate/certified_mesh.h"

namespace periost {

inline constexpr std::size_t kMaxFan = 16;  // triangles of a ring that the overlay takes

struct Planar {
  double x, y;
};
inline double planar_turn(Planar a, Planar b) {
  return a.x * b.y - a.y * b.x;
}
inline Planar operator-(Planar a, Planar b) {
  return {a.x - b.x, a.y - b.y};
}

// The new triangles in the plane, the apex at the origin. Lines 0 to spokes - 1 lead from the apex to each
// vertex of the rim, lines spokes + j along the rim of cell j.
struct Fan {
  struct Line {
    Planar from, along;
    double height, rise;  // at `from`, and from there to the other end
    double per_squared_length;
    std::uint32_t cells = 0;  // beside it
    bool is_border = false;
  };
  struct Cell {
    std::uint32_t a, b;  // its spokes, counter-clockwise
    double slope_x, slope_y;
  };
  std::size_t spokes = 0, cells = 0;
  bool is_cyclic = true;  // cell j has spokes j and j + 1
  std::array<Index, kMaxFan + 1> vertex;
  std::array<Vec3, kMaxFan + 1> rim;  // x, y and height
  std::array<std::uint32_t, kMaxFan + 1> lines_at{}, cells_at{};
  std::array<Cell, kMaxFan> cell;
  std::array<Line, 2 * kMaxFan> line;
  std::array<double, kMaxFan + 1> rim_x, rim_y;  // of `rim` again, for what is asked of all its vertices
  // The offset of (x, y) from line l is cx[l] * x + cy[l] * y + c[l].
  std::array<double, 2 * kMaxFan> cx, cy, c;
  Vec3 origin, axis_x, axis_y, axis_z;

  Vec3 to_fan(Vec3 p) const {
    const Vec3 d = p - origin;
    return {dot(d, axis_x), dot(d, axis_y), dot(d, axis_z)};
  }
  std::size_t lines() const { return spokes + cells; }
  // From bits of spokes to those of the cells that have them first or second.
  std::uint32_t of_first(std::uint32_t bits) const { return is_cyclic ? bits : gathered(bits, &Cell::a); }
  std::uint32_t of_second(std::uint32_t bits) const {
    return is_cyclic ? (bits & all_spokes()) >> 1 | (bits & 1u) << (spokes - 1) : gathered(bits, &Cell::b);
  }
  // The spokes at whose end all lines that meet there are among these.
  std::uint32_t ends_of(std::uint32_t lines) const {
    if (is_cyclic) {
      const std::uint32_t borders = lines >> spokes;
      return lines & all_spokes() & borders & (borders << 1 | borders >> (spokes - 1));
    }
    std::uint32_t found = 0;
    for (std::size_t i = 0; i < spokes; ++i) {
      found |= static_cast<std::uint32_t>((lines & lines_at[i]) == lines_at[i]) << i;
    }
    return found;
  }
  std::uint32_t all_spokes() const { return (1u << spokes) - 1; }
  std::uint32_t gathered(std::uint32_t bits, std::uint32_t Cell::*end) const {
    std::uint32_t found = 0;
    for (std::size_t j = 0; j < cells; ++j) found |= (bits >> cell[j].*end & 1u) << j;
    return found;
  }
  double height(std::size_t j, Planar p) const { return cell[j].slope_x * p.x + cell[j].slope_y * p.y; }
};

// The corner that all new triangles of a proposal share: its moved vertex, or of two triangles the first that
// both have; kNoIndex when there is none.
Index apex_of(const Proposal& proposal);

// False when the new triangles are no fan, or their shadows do not tile a polygon. `fan`: a new one.
// O(triangles squared).
bool make_fan(const CertifiedMesh& mesh, const Proposal& proposal, Fan& fan);

}  // namespace periost
