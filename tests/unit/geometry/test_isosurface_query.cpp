// Queries against an exhaustive search over all triangles, in oblique, anisotropic, right- and left-handed
// grids.
#include "pipeline/geometry/isosurface_query.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pipeline/base/random.h"
#include "stages/marching_cubes/marching_cubes.h"

namespace periost {
namespace {

struct QueryCase {
  bool left_handed = false;
  bool noisy = false;
};

GridFrame frame_of(bool left_handed) {
  const double c = std::cos(0.5);
  const double s = std::sin(0.5);
  GridFrame frame{{20, 17, 14}, {0.7, 1.1, 1.9}, {-31, 12, 55}, {{Vec3{c, s, 0}, {-s, c, 0}, {0, 0, 1}}}};
  if (left_handed) frame.direction.column[2] = -frame.direction.column[2];
  return frame;
}

// A ball, or a ball in noise: smooth and rough surfaces.
Isosurface isosurface_of(const QueryCase& c) {
  Image image{frame_of(c.left_handed), {}};
  Random random(7, 0);
  const Vec3 centre = image.frame.to_lps({9.3, 8.1, 6.8});
  const auto& dims = image.frame.dims;
  for (std::int32_t k = 0; k < dims[2]; ++k) {
    for (std::int32_t j = 0; j < dims[1]; ++j) {
      for (std::int32_t i = 0; i < dims[0]; ++i) {
        const Vec3 p = image.frame.to_lps({double(i), double(j), double(k)});
        const double noise = c.noisy ? 9 * (random.uniform() - 0.5) : 0;
        image.values.push_back(static_cast<float>(5 - distance(p, centre) + noise));
      }
    }
  }
  return marching_cubes(image, {.lower = 0}, {}, Context());
}

Vec3 random_point(Random& random, const Isosurface& isosurface, double margin) {
  const auto& frame = isosurface.frame;
  Vec3 index;
  for (std::size_t a = 0; a < 3; ++a) {
    index[a] = -margin + random.uniform() * (frame.dims[a] - 1 + 2 * margin);
  }
  return frame.to_lps(index);
}

Vec3 random_direction(Random& random) {
  while (true) {
    const Vec3 v{random.uniform() - 0.5, random.uniform() - 0.5, random.uniform() - 0.5};
    if (norm(v) > 0.05) return normalized(v);
  }
}

double exhaustive_distance(const Isosurface& isosurface, Vec3 p) {
  double nearest = 1e300;
  const auto& points = isosurface.surface.points;
  for (const auto& [a, b, c] : isosurface.surface.triangles) {
    nearest = std::min(nearest, distance(p, closest_point_on_triangle(p, points[a], points[b], points[c])));
  }
  return nearest;
}

// Nearest intersection with a facet that faces along n, or infinity.
double exhaustive_line(const Isosurface& isosurface, Vec3 p, Vec3 n) {
  double nearest = 1e300;
  const auto& points = isosurface.surface.points;
  for (const auto& [ia, ib, ic] : isosurface.surface.triangles) {
    const Vec3 a = points[ia];
    const Vec3 normal = cross(points[ib] - a, points[ic] - a);
    if (!(dot(normal, n) > 0)) continue;
    const double t = dot(normal, a - p) / dot(normal, n);
    const Vec3 q = p + n * t;
    // Inside when the three areas of (q, corner, corner) add up to the whole.
    const double whole = norm(normal);
    const double parts = norm(cross(a - q, points[ib] - q)) + norm(cross(points[ib] - q, points[ic] - q)) +
                         norm(cross(points[ic] - q, a - q));
    if (parts <= whole * (1 + 1e-9)) nearest = std::min(nearest, std::abs(t));
  }
  return nearest;
}

class IsosurfaceQuery : public testing::TestWithParam<QueryCase> {};

TEST_P(IsosurfaceQuery, ClosestPointIsTheExhaustiveOne) {
  const Isosurface isosurface = isosurface_of(GetParam());
  Random random(3, 1);
  for (int n = 0; n < 400; ++n) {
    const Vec3 p = random_point(random, isosurface, 6);
    const double exact = exhaustive_distance(isosurface, p);
    const auto found = closest_point(isosurface, p, 100);
    ASSERT_TRUE(found.has_value());
    EXPECT_NEAR(found->distance, exact, 1e-12);
    EXPECT_NEAR(distance(found->point, p), exact, 1e-12);
    const auto& [a, b, c] = isosurface.surface.triangles[found->triangle];
    const auto& points = isosurface.surface.points;
    EXPECT_NEAR(distance(closest_point_on_triangle(p, points[a], points[b], points[c]), found->point), 0,
                1e-12);
    EXPECT_FALSE(closest_point(isosurface, p, 0.999 * exact).has_value());
    EXPECT_TRUE(closest_point(isosurface, p, 1.001 * exact).has_value());
  }
}

TEST_P(IsosurfaceQuery, LineHitIsTheExhaustiveOne) {
  const Isosurface isosurface = isosurface_of(GetParam());
  Random random(3, 2);
  int hits = 0;
  for (int n = 0; n < 1500; ++n) {
    const Vec3 p = random_point(random, isosurface, 2);
    const Vec3 direction =
        n % 10 == 0 ? isosurface.frame.direction.column[n / 10 % 3] : random_direction(random);
    const double exact = exhaustive_line(isosurface, p, direction);
    const auto found = closest_along_line(isosurface, p, direction, 100);
    ASSERT_EQ(found.has_value(), exact < 100) << n;
    if (!found) continue;
    ++hits;
    EXPECT_NEAR(found->distance, exact, 1e-9);
    EXPECT_NEAR(distance(found->point, p), exact, 1e-9);
    EXPECT_GE(found->distance, closest_point(isosurface, p, 100)->distance - 1e-9);
    EXPECT_FALSE(closest_along_line(isosurface, p, direction, 0.999 * exact).has_value());
  }
  EXPECT_GT(hits, 200);
}

TEST_P(IsosurfaceQuery, EveryTriangleLiesInItsCell) {
  const Isosurface isosurface = isosurface_of(GetParam());
  const auto& mesh = isosurface.surface;
  for (Index t = 0; t < mesh.triangles.size(); ++t) {
    const Cell cell = cell_of_triangle(isosurface, t);
    const TriangleRange range = isosurface.triangles_of_cell(cell.i, cell.j, cell.k);
    EXPECT_TRUE(range.begin <= t && t < range.end);
    Vec3 middle;
    for (const Index v : mesh.triangles[t]) {
      const Vec3 x = isosurface.frame.to_index(mesh.points[v]);
      EXPECT_TRUE(x.x >= cell.i - 1e-9 && x.x <= cell.i + 1 + 1e-9 && x.y >= cell.j - 1e-9 &&
                  x.y <= cell.j + 1 + 1e-9 && x.z >= cell.k - 1e-9 && x.z <= cell.k + 1 + 1e-9);
      middle += mesh.points[v] / 3;
    }
    EXPECT_EQ(cell_at(isosurface.frame, middle), cell);
  }
}

INSTANTIATE_TEST_SUITE_P(Grids, IsosurfaceQuery,
                         testing::Values(QueryCase{false, false}, QueryCase{true, false},
                                         QueryCase{false, true}, QueryCase{true, true}),
                         [](const auto& test) {
                           return std::string(test.param.left_handed ? "LeftHanded" : "RightHanded") +
                                  (test.param.noisy ? "Noisy" : "Smooth");
                         });

TEST(IsosurfaceQueryLine, LooksOnlyAtFacetsThatFaceItsWay) {
  // A slab of two voxels: from its upper side, looking down, the nearest facet is the lower one.
  Image image{GridFrame{{8, 8, 8}, {1, 1, 1}, {10, 20, 30}, {}}, std::vector<float>(512, 0.0f)};
  for (std::size_t v = 3 * 64; v < 5 * 64; ++v) image.values[v] = 2;
  const Isosurface slab = marching_cubes(image, {.lower = 1}, {}, Context());
  const Vec3 p{13.2, 23.3, 30 + 4.4};
  EXPECT_NEAR(closest_along_line(slab, p, {0, 0, 1}, 5)->distance, 0.1, 1e-12);
  EXPECT_NEAR(closest_along_line(slab, p, {0, 0, -1}, 5)->distance, 1.9, 1e-12);
  EXPECT_NEAR(closest_point(slab, p, 5)->distance, 0.1, 1e-12);
}

}  // namespace
}  // namespace periost
