#pragma once
// What marching cubes does in a cell: for each pattern of inside corners and each way to decide its ambiguous
// faces, the closed loops of cell edges that bound the surface's polygons.
//
// Corner c of a cell lies at (c & 1, c >> 1 & 1, c >> 2 & 1). Edge e runs along axis a = e / 4 from the
// corner whose offsets in the axes (a + 1) % 3 and (a + 2) % 3 are e & 1 and e >> 1 & 1. Face f is the one at
// side f & 1 of axis f / 2.
#include <array>
#include <cstdint>
#include <vector>

namespace periost {

inline constexpr int kCellEdges = 12;

// The corner where a cell edge begins; it ends one step further along its axis.
constexpr int edge_begin(int edge) {
  const int axis = edge / 4;
  return (edge & 1) << ((axis + 1) % 3) | (edge >> 1 & 1) << ((axis + 2) % 3);
}
constexpr int edge_end(int edge) {
  return edge_begin(edge) | 1 << (edge / 4);
}

// A closed polygon around one sheet of the surface in a cell, anticlockwise seen from outside (in a
// right-handed grid). `chords[i]` has bit j set when vertices i and j may be joined by a triangle's edge:
// they are neighbours on the loop, or share no face of the cell. (A chord within a face could be made by the
// neighbouring cell as well.)
struct CellLoop {
  std::uint8_t size = 0;
  std::array<std::uint8_t, kCellEdges> edges{};
  std::array<std::uint16_t, kCellEdges> chords{};
};

// An ambiguous face: two inside corners on a diagonal, two outside corners on the other.
struct AmbiguousFace {
  std::array<std::uint8_t, 2> inside{};
  std::array<std::uint8_t, 2> outside{};
};

// The 256 patterns. Pattern p has bit c set when corner c is inside.
class CaseTable {
 public:
  struct Pattern {
    std::uint16_t crossed_edges = 0;  // bit e: the surface crosses edge e
    std::uint8_t ambiguous_count = 0;
    std::array<AmbiguousFace, 6> ambiguous{};
    std::uint32_t first_choice = 0;  // see loops()
  };

  // Built on first use, in well under a millisecond; constant afterwards.
  static const CaseTable& instance();

  const Pattern& pattern(int p) const { return patterns_[static_cast<std::size_t>(p)]; }
  // The loops of a pattern; bit n of `joined` tells that the inside corners of ambiguous face n are joined.
  const std::vector<CellLoop>& loops(const Pattern& pattern, unsigned joined) const {
    return loops_[pattern.first_choice + joined];
  }

 private:
  CaseTable();
  std::array<Pattern, 256> patterns_;
  std::vector<std::vector<CellLoop>> loops_;
};

}  // namespace periost
