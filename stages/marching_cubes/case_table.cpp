#include "stages/marching_cubes/case_table.h"

#include <algorithm>

namespace periost {
namespace {

constexpr int kNone = -1;

int side_of(int corner, int axis) {
  return corner >> axis & 1;
}

// The four corners of a face, anticlockwise seen from outside the cell.
std::array<int, 4> corners_of_face(int face) {
  const int axis = face / 2;
  const int u = 1 << ((axis + 1) % 3);
  const int v = 1 << ((axis + 2) % 3);
  const int base = (face & 1) << axis;
  if ((face & 1) != 0) return {base, base | u, base | u | v, base | v};
  return {base, base | v, base | u | v, base | u};
}

int edge_between(int a, int b) {
  for (int edge = 0; edge < kCellEdges; ++edge) {
    if ((edge_begin(edge) == a && edge_end(edge) == b) || (edge_begin(edge) == b && edge_end(edge) == a)) {
      return edge;
    }
  }
  return kNone;
}

bool is_on_face(int edge, int face) {
  return side_of(edge_begin(edge), face / 2) == (face & 1) && side_of(edge_end(edge), face / 2) == (face & 1);
}

bool share_face(int edge, int other) {
  for (int face = 0; face < 6; ++face) {
    if (is_on_face(edge, face) && is_on_face(other, face)) return true;
  }
  return false;
}

bool is_ambiguous(int pattern, const std::array<int, 4>& c) {
  const auto inside = [&](int n) { return (pattern >> c[static_cast<std::size_t>(n)] & 1) != 0; };
  return inside(0) == inside(2) && inside(1) == inside(3) && inside(0) != inside(1);
}

// next[e] is the edge that follows e on its loop. On each face a segment runs from the edge where the walk
// around the face (anticlockwise seen from outside) enters the inside to the edge where it leaves it. The
// neighbour walks the other way round, so its segment runs the opposite way, as two oriented polygons on one
// edge must.
void add_face_segments(int pattern, int face, bool is_joined, std::array<int, kCellEdges>& next) {
  const auto c = corners_of_face(face);
  const auto corner = [&](int n) { return c[static_cast<std::size_t>(n & 3)]; };
  const auto inside = [&](int n) { return (pattern >> corner(n) & 1) != 0; };
  const bool ambiguous = is_ambiguous(pattern, c);
  for (int n = 0; n < 4; ++n) {
    if (!inside(n) || inside(n + 1)) continue;  // only where the walk leaves the inside
    const int leave = edge_between(corner(n), corner(n + 1));
    int enter = n + 1;  // the walk enters between corners `enter` and `enter + 1`
    if (ambiguous && !is_joined) {
      enter = n + 3;  // around the inside corner n
    } else {
      while (inside(enter) || !inside(enter + 1)) ++enter;  // around the outside corners
    }
    next[static_cast<std::size_t>(edge_between(corner(enter), corner(enter + 1)))] = leave;
  }
}

void find_chords(CellLoop& loop) {
  const int n = loop.size;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const bool is_side = (i + 1) % n == j || (j + 1) % n == i;
      const auto e = loop.edges[static_cast<std::size_t>(i)];
      const auto f = loop.edges[static_cast<std::size_t>(j)];
      if (i != j && (is_side || !share_face(e, f))) {
        loop.chords[static_cast<std::size_t>(i)] |= static_cast<std::uint16_t>(1 << j);
      }
    }
  }
}

std::vector<CellLoop> trace_loops(int pattern, unsigned joined, const std::array<int, 6>& ambiguous_of_face) {
  std::array<int, kCellEdges> next;
  next.fill(kNone);
  for (int face = 0; face < 6; ++face) {
    const int number = ambiguous_of_face[static_cast<std::size_t>(face)];
    add_face_segments(pattern, face, number != kNone && (joined >> number & 1) != 0, next);
  }
  std::vector<CellLoop> loops;
  std::array<bool, kCellEdges> done{};
  for (int start = 0; start < kCellEdges; ++start) {
    if (next[static_cast<std::size_t>(start)] == kNone || done[static_cast<std::size_t>(start)]) continue;
    CellLoop loop;
    for (int edge = start; !done[static_cast<std::size_t>(edge)];
         edge = next[static_cast<std::size_t>(edge)]) {
      done[static_cast<std::size_t>(edge)] = true;
      loop.edges[loop.size++] = static_cast<std::uint8_t>(edge);
    }
    find_chords(loop);
    loops.push_back(loop);
  }
  return loops;
}

AmbiguousFace ambiguous_face(int pattern, const std::array<int, 4>& c) {
  const std::size_t first = (pattern >> c[0] & 1) != 0 ? 0 : 1;
  const auto corner = [&](std::size_t n) { return static_cast<std::uint8_t>(c[n % 4]); };
  return {{corner(first), corner(first + 2)}, {corner(first + 1), corner(first + 3)}};
}

}  // namespace

CaseTable::CaseTable() {
  for (int p = 0; p < 256; ++p) {
    Pattern& pattern = patterns_[static_cast<std::size_t>(p)];
    for (int edge = 0; edge < kCellEdges; ++edge) {
      if ((p >> edge_begin(edge) & 1) != (p >> edge_end(edge) & 1)) {
        pattern.crossed_edges |= static_cast<std::uint16_t>(1 << edge);
      }
    }
    std::array<int, 6> ambiguous_of_face;
    ambiguous_of_face.fill(kNone);
    for (int face = 0; face < 6; ++face) {
      const auto c = corners_of_face(face);
      if (!is_ambiguous(p, c)) continue;
      ambiguous_of_face[static_cast<std::size_t>(face)] = pattern.ambiguous_count;
      pattern.ambiguous[pattern.ambiguous_count++] = ambiguous_face(p, c);
    }
    pattern.first_choice = static_cast<std::uint32_t>(loops_.size());
    for (unsigned joined = 0; joined < 1u << pattern.ambiguous_count; ++joined) {
      loops_.push_back(trace_loops(p, joined, ambiguous_of_face));
    }
  }
}

const CaseTable& CaseTable::instance() {
  static const CaseTable table;
  return table;
}

}  // namespace periost
