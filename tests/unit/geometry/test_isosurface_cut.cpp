// Cutting and merging in anisotropic, oblique, right- and left-handed grids off the origin.
#include "pipeline/geometry/isosurface_cut.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pipeline/base/random.h"
#include "pipeline/geometry/isosurface_query.h"
#include "pipeline/geometry/topology.h"
#include "stages/marching_cubes/marching_cubes.h"

namespace periost {
namespace {

struct CutCase {
  bool left_handed = false;
  bool noisy = false;
  bool open = false;
};

// A torus around axis k, in a grid that an open one leaves at one end.
Isosurface torus(const CutCase& c) {
  const double cosine = std::cos(0.5), sine = std::sin(0.5);
  Image image{{{26, 24, 19},
               {0.7, 0.8, 1.9},
               {-31, 12, 55},
               {{Vec3{cosine, sine, 0}, {-sine, cosine, 0}, {0, 0, c.left_handed ? -1.0 : 1.0}}}},
              {}};
  Random random(3, 0);
  const double middle = c.open ? 2.0 : 12.5;
  for (std::int32_t k = 0; k < 19; ++k) {
    for (std::int32_t j = 0; j < 24; ++j) {
      for (std::int32_t i = 0; i < 26; ++i) {
        const double ring = std::hypot(i - middle, j - 11.6) - 7.1;
        const double depth = 3.2 - std::hypot(ring, 1.7 * (k - 9.3));
        image.values.push_back(static_cast<float>(depth + (c.noisy ? 4 * (random.uniform() - 0.5) : 0)));
      }
    }
  }
  return marching_cubes(image, {.lower = 0}, {.open = c.open}, Context());
}

// Triangles by the places of their corners.
std::vector<std::array<Vec3, 3>> soup(const Isosurface& isosurface) {
  std::vector<std::array<Vec3, 3>> triangles;
  for (const Triangle& t : isosurface.surface.triangles) {
    const auto& p = isosurface.surface.points;
    triangles.push_back({p[t[0]], p[t[1]], p[t[2]]});
  }
  return triangles;
}

std::vector<Isosurface> all_parts(const Isosurface& whole, const CutPlanes& planes) {
  std::vector<Isosurface> parts;
  for (std::size_t i = 0; i <= planes.at.size(); ++i) parts.push_back(cut_part(whole, planes, i));
  return parts;
}

class IsosurfaceCut : public testing::TestWithParam<CutCase> {};

TEST_P(IsosurfaceCut, CutThenMergedIsTheSameSurfaceInAnyOrderOfParts) {
  const Isosurface whole = torus(GetParam());
  for (const CutPlanes& planes : {CutPlanes{0, {1, 5, 12, 17}}, CutPlanes{1, {8, 16}}, CutPlanes{2, {9}}}) {
    std::vector<Isosurface> parts = all_parts(whole, planes);
    std::size_t triangles = 0;
    for (const Isosurface& part : parts) triangles += part.surface.triangles.size();
    EXPECT_EQ(triangles, whole.surface.triangles.size());
    std::reverse(parts.begin(), parts.end());
    const Isosurface merged = merge_isosurfaces(parts);
    EXPECT_EQ(soup(merged), soup(whole));
    EXPECT_EQ(merged.surface.points.size(), whole.surface.points.size());
    EXPECT_EQ(merged.is_open, GetParam().open);
    EXPECT_EQ(merged.surface.voxel_mm, whole.surface.voxel_mm);
    // The block table finds the same triangles.
    for (Index t = 0; t < merged.surface.triangles.size(); t += 7)
      EXPECT_EQ(cell_of_triangle(merged, t), cell_of_triangle(whole, t));
  }
}

TEST_P(IsosurfaceCut, PartsAreManifoldsOpenAlongTheCutOnlyAndQueriesWorkOnThem) {
  const Isosurface whole = torus(GetParam());
  const CutPlanes planes{1, {8, 16}};
  const auto parts = all_parts(whole, planes);
  for (std::size_t i = 0; i < 3; ++i) {
    const Topology topology = examine_topology(parts[i].surface);
    EXPECT_TRUE(topology.is_manifold());
    EXPECT_TRUE(topology.is_oriented());
    EXPECT_EQ(topology.unused_points, 0u);
    EXPECT_TRUE(parts[i].is_open);
    for (Index t = 0; t < parts[i].surface.triangles.size(); t += 5) {
      const Triangle& corners = parts[i].surface.triangles[t];
      const auto& p = parts[i].surface.points;
      const Cell cell = cell_of_triangle(parts[i], t);
      EXPECT_EQ(cell.j < 8 ? 0u : cell.j < 16 ? 1u : 2u, i);
      const Vec3 centre = (p[corners[0]] + p[corners[1]] + p[corners[2]]) / 3.0;
      const auto closest = closest_point(parts[i], centre, 1);
      ASSERT_TRUE(closest);
      EXPECT_LT(closest->distance, 1e-12);
    }
  }
}

TEST_P(IsosurfaceCut, CostsAreThoseOfTheOpenEdgesOfAPart) {
  const Isosurface whole = torus(GetParam());
  const auto costs = cut_costs(whole);
  const double own = [&] {
    double length = 0;
    for (const EdgeUse& use : sorted_edge_uses(whole.surface.triangles, whole.surface.points.size())) {
      length += distance(whole.surface.points[use.a], whole.surface.points[use.b]);
    }
    return length;
  }();
  for (int axis = 0; axis < 3; ++axis) {
    for (const std::int32_t c : {4, 9, 13}) {
      // What the cut adds to the border, from the sides of the parts' edges.
      double border = 0, sides = 0;
      for (const Isosurface& part : all_parts(whole, {axis, {c}})) {
        const auto& s = part.surface;
        for (const EdgeUse& use : sorted_edge_uses(s.triangles, s.points.size()))
          sides += distance(s.points[use.a], s.points[use.b]);
        const auto neighbours = triangle_neighbours(s.triangles, s.points.size());
        for (std::size_t t = 0; t < neighbours.size(); ++t) {
          for (std::size_t k = 0; k < 3; ++k) {
            const Vec3 p = s.points[s.triangles[t][(k + 1) % 3]], q = s.points[s.triangles[t][(k + 2) % 3]];
            const Vec3 a = whole.frame.to_index(p), b = whole.frame.to_index(q);
            const auto x = static_cast<std::size_t>(axis);
            if (neighbours[t][k] == kNoIndex && std::abs(a[x] - c) < 1e-9 && std::abs(b[x] - c) < 1e-9)
              border += distance(p, q);
          }
        }
      }
      EXPECT_NEAR(sides, own, 1e-9 * own);
      EXPECT_NEAR(costs[static_cast<std::size_t>(axis)][static_cast<std::size_t>(c)].length_mm, 0.5 * border,
                  1e-9 * own);
    }
  }
}

TEST_P(IsosurfaceCut, PiecesAreOfEqualSize) {
  const Isosurface whole = torus(GetParam());
  for (const std::uint32_t pieces : {1u, 2u, 3u}) {
    const CutPlanes planes = choose_cut(whole, pieces);
    ASSERT_EQ(planes.at.size(), pieces - 1);
    EXPECT_TRUE(std::is_sorted(planes.at.begin(), planes.at.end()));
    for (std::size_t i = 0; i < pieces; ++i) {
      const double share = static_cast<double>(cut_part(whole, planes, i).surface.triangles.size()) * pieces /
                           static_cast<double>(whole.surface.triangles.size());
      EXPECT_NEAR(share, 1, 0.5);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Grids, IsosurfaceCut,
                         testing::Values(CutCase{}, CutCase{.left_handed = true}, CutCase{.noisy = true},
                                         CutCase{.left_handed = true, .noisy = true, .open = true},
                                         CutCase{.open = true}));

TEST(IsosurfaceCutCosts, CountsTheIsocontoursOfATorus) {
  const Isosurface whole = torus({});
  const auto costs = cut_costs(whole);
  EXPECT_EQ(costs[0][12].contours, 2u);  // across the hole: two sections of the tube
  EXPECT_EQ(costs[0][3].contours, 1u);   // off the hole: one
  EXPECT_EQ(costs[2][9].contours, 2u);   // along the ring: the outer and the inner circle
  EXPECT_EQ(costs[2][0].contours, 0u);
  // Slicing across the ring is as good as any other in contours, and shorter than along it.
  const CutPlanes planes = choose_cut(whole, 2);
  EXPECT_NE(planes.axis, 2);
  EXPECT_LT(costs[0][12].length_mm, costs[2][9].length_mm);
}

TEST(IsosurfaceCutCosts, TooManyPiecesGiveWhatTheImageAllows) {
  const Isosurface whole = torus({});
  const CutPlanes planes = choose_cut(whole, 1000);
  EXPECT_LE(planes.at.size(), 24u);
  EXPECT_EQ(std::adjacent_find(planes.at.begin(), planes.at.end(), std::greater_equal<>()), planes.at.end());
  EXPECT_EQ(soup(merge_isosurfaces(all_parts(whole, planes))), soup(whole));
}

}  // namespace
}  // namespace periost
