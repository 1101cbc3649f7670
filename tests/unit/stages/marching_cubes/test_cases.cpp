// The case table: every pattern with every decision about its ambiguous faces.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <set>
#include <utility>

#include "pipeline/base/random.h"
#include "pipeline/geometry/topology.h"
#include "stages/marching_cubes/case_table.h"
#include "stages/marching_cubes/marching_cubes.h"
#include "stages/marching_cubes/polygon.h"

namespace periost {
namespace {

using Segment = std::pair<int, int>;

const CaseTable& table() {
  return CaseTable::instance();
}

bool lies_on_face(int edge, int face) {
  const int axis = face / 2;
  return (edge_begin(edge) >> axis & 1) == (face & 1) && (edge_end(edge) >> axis & 1) == (face & 1);
}

// The directed sides that the loops of a cell have on a face.
std::set<Segment> segments_on_face(const std::vector<CellLoop>& loops, int face) {
  std::set<Segment> segments;
  for (const CellLoop& loop : loops) {
    for (int n = 0; n < loop.size; ++n) {
      const int from = loop.edges[static_cast<std::size_t>(n)];
      const int to = loop.edges[static_cast<std::size_t>((n + 1) % loop.size)];
      if (lies_on_face(from, face) && lies_on_face(to, face)) segments.insert({from, to});
    }
  }
  return segments;
}

// The edge of the neighbour across `face` that is this cell's `edge`.
int edge_in_neighbour(int edge, int face) {
  const int axis = face / 2;
  for (int other = 0; other < kCellEdges; ++other) {
    if (edge_begin(other) == (edge_begin(edge) ^ 1 << axis) &&
        edge_end(other) == (edge_end(edge) ^ 1 << axis)) {
      return other;
    }
  }
  return -1;
}

// The decision about a face of a pattern: 0 separate or 1 joined; -1 if the face is not ambiguous.
int decision(const CaseTable::Pattern& pattern, unsigned joined, int face) {
  for (unsigned n = 0; n < pattern.ambiguous_count; ++n) {
    const AmbiguousFace& a = pattern.ambiguous[n];
    const int axis = face / 2;
    const auto on = [&](int corner) { return (corner >> axis & 1) == (face & 1); };
    if (on(a.inside[0]) && on(a.inside[1]) && on(a.outside[0]) && on(a.outside[1]))
      return joined >> n & 1 ? 1 : 0;
  }
  return -1;
}

template <class Visit>
void for_each_choice(Visit&& visit) {
  for (int p = 0; p < 256; ++p) {
    const auto& pattern = table().pattern(p);
    for (unsigned joined = 0; joined < 1u << pattern.ambiguous_count; ++joined) visit(p, pattern, joined);
  }
}

TEST(CaseTable, LoopsUseEveryCrossedEdgeOnce) {
  for_each_choice([](int p, const CaseTable::Pattern& pattern, unsigned joined) {
    unsigned used = 0;
    for (const CellLoop& loop : table().loops(pattern, joined)) {
      EXPECT_GE(loop.size, 3);
      for (int n = 0; n < loop.size; ++n) {
        const unsigned bit = 1u << loop.edges[static_cast<std::size_t>(n)];
        EXPECT_EQ(used & bit, 0u);
        used |= bit;
      }
    }
    EXPECT_EQ(used, pattern.crossed_edges) << p;
  });
}

// Two cells that share a face see the same four corners and decide alike; the sides of their loops there must
// be the same, run the other way round. Checked for all 256 patterns, all six faces, all decisions, against
// every pattern of the neighbour.
TEST(CaseTable, NeighboursAgreeOnEveryFace) {
  std::size_t pairs = 0;
  for_each_choice([&](int p, const CaseTable::Pattern& pattern, unsigned joined) {
    for (int face = 1; face < 6; face += 2) {
      const int axis = face / 2;
      const int mine = decision(pattern, joined, face);
      std::set<Segment> expected;
      for (const auto& [from, to] : segments_on_face(table().loops(pattern, joined), face)) {
        expected.insert({edge_in_neighbour(to, face), edge_in_neighbour(from, face)});
      }
      for (int q = 0; q < 256; ++q) {
        bool fits = true;
        for (int c = 0; c < 8; ++c) {
          if ((c >> axis & 1) == 1 && (p >> c & 1) != (q >> (c ^ 1 << axis) & 1)) fits = false;
        }
        if (!fits) continue;
        const auto& neighbour = table().pattern(q);
        for (unsigned choice = 0; choice < 1u << neighbour.ambiguous_count; ++choice) {
          if (decision(neighbour, choice, face ^ 1) != mine) continue;
          EXPECT_EQ(segments_on_face(table().loops(neighbour, choice), face ^ 1), expected) << p << " " << q;
          ++pairs;
        }
      }
    }
  });
  EXPECT_GT(pairs, 3u * 256 * 16);
}

// With its vertices at random places on their edges, every loop can be cut without chords on the cell's
// faces, or is joined to its centroid; no triangle is degenerate or lies in a face.
TEST(CaseTable, EveryLoopIsCutWithoutChordsOnFaces) {
  Random random(5, 0);
  std::size_t without = 0;
  std::size_t loops = 0;
  for_each_choice([&](int, const CaseTable::Pattern& pattern, unsigned joined) {
    for (const CellLoop& loop : table().loops(pattern, joined)) {
      std::array<Vec3, kCellEdges> points{};
      for (std::size_t n = 0; n < loop.size; ++n) {
        const int corner = edge_begin(loop.edges[n]);
        points[n] = {double(corner & 1), double(corner >> 1 & 1), double(corner >> 2 & 1)};
        points[n][loop.edges[n] / 4u] += 0.02 + 0.96 * random.uniform();
      }
      const LoopTriangles cut = triangulate_loop(loop, points);
      ++loops;
      if (cut.count == 0) {
        ++without;
        continue;
      }
      EXPECT_EQ(cut.count, loop.size - 2);
      for (int t = 0; t < cut.count; ++t) {
        const auto& [a, b, c] = cut.triangles[static_cast<std::size_t>(t)];
        EXPECT_NE(loop.chords[a] >> b & 1, 0);
        EXPECT_NE(loop.chords[b] >> c & 1, 0);
        EXPECT_NE(loop.chords[c] >> a & 1, 0);
        EXPECT_GT(norm(cross(points[b] - points[a], points[c] - points[a])), 1e-4);
      }
    }
  });
  EXPECT_GT(loops, 256u);
  EXPECT_LT(without, loops / 5);
}

// The whole extractor on every pattern: values at random, many of them ties.
TEST(CaseTable, EveryPatternMakesAClosedSurface) {
  Random random(6, 0);
  for (int p = 1; p < 256; ++p) {
    for (int trial = 0; trial < 8; ++trial) {
      Image image{GridFrame{{2, 2, 2}, {1, 2, 0.5}, {7, 8, 9}, {}}, std::vector<float>(8)};
      for (std::size_t c = 0; c < 8; ++c) {
        const auto size = static_cast<float>(random.below(3));
        image.values[c] = (p >> c & 1) != 0 ? size : -1 - size;
      }
      const Isosurface isosurface = marching_cubes(image, {.lower = 0}, {}, Context());
      EXPECT_EQ(describe_violations(examine_topology(isosurface.surface)), "") << p;
      EXPECT_GT(signed_volume(isosurface.surface), 0) << p;
    }
  }
}

// A cell's value on a face is bilinear; the decider joins the inside corners exactly when its saddle is
// inside.
TEST(CaseTable, DeciderFollowsTheSaddle) {
  for (const auto& [inside, outside, components] :
       {std::tuple{3.0, -1.0, 1u}, {1.0, -3.0, 2u}, {2.0, -2.0, 2u}}) {
    Image image{GridFrame{{2, 2, 1}, {1, 1, 1}, {0, 0, 0}, {}}, {}};
    for (const double v : {inside, outside, outside, inside}) image.values.push_back(static_cast<float>(v));
    const Isosurface isosurface = marching_cubes(image, {.lower = 0}, {}, Context());
    EXPECT_EQ(examine_topology(isosurface.surface).components, components) << inside;
  }
}

}  // namespace
}  // namespace periost
