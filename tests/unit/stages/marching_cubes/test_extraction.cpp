// Properties of the isosurface: closed, manifold, oriented, without crossing or degenerate triangles, on
// random grids with ties too; volumes of known bodies; the same bits for any number of threads.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "pipeline/base/error.h"
#include "pipeline/base/random.h"
#include "pipeline/geometry/topology.h"
#include "stages/marching_cubes/marching_cubes.h"

namespace periost {
namespace {

Mat3 rotation(double angle, Vec3 axis) {
  const Vec3 u = normalized(axis);
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  Mat3 m;
  for (std::size_t n = 0; n < 3; ++n) {
    Vec3 e;
    e[n] = 1;
    m.column[n] = e * c + cross(u, e) * s + u * (dot(u, e) * (1 - c));
  }
  return m;
}

GridFrame oblique_frame(std::array<std::int32_t, 3> dims, bool left_handed) {
  GridFrame frame{dims, {0.7, 1.1, 1.9}, {-31, 12, 55}, rotation(0.6, {1, 2, -1})};
  if (left_handed) frame.direction.column[1] = -frame.direction.column[1];
  return frame;
}

// Grey values 0 .. levels - 1, so that many equal the threshold exactly.
Image noise(std::array<std::int32_t, 3> dims, std::uint32_t levels, std::uint64_t seed) {
  Image image{oblique_frame(dims, seed % 2 == 0), {}};
  Random random(seed, 0);
  image.values.resize(image.frame.voxel_count());
  for (float& value : image.values) value = static_cast<float>(random.below(levels));
  return image;
}

template <class Function>
Image sampled(const GridFrame& frame, Function&& function) {
  Image image{frame, {}};
  for (std::int32_t k = 0; k < frame.dims[2]; ++k) {
    for (std::int32_t j = 0; j < frame.dims[1]; ++j) {
      for (std::int32_t i = 0; i < frame.dims[0]; ++i) {
        const Vec3 p = frame.to_lps({double(i), double(j), double(k)});
        image.values.push_back(static_cast<float>(function(p)));
      }
    }
  }
  return image;
}

double smallest_area(const SurfaceMesh& mesh) {
  double smallest = 1e300;
  for (const auto& [a, b, c] : mesh.triangles) {
    smallest = std::min(smallest, norm(area_vector(mesh.points[a], mesh.points[b], mesh.points[c])));
  }
  return smallest;
}

// Strict crossing of a segment with the inside of a triangle.
bool pierces(Vec3 p, Vec3 q, Vec3 a, Vec3 b, Vec3 c) {
  const auto volume = [](Vec3 u, Vec3 v, Vec3 w, Vec3 x) { return dot(cross(v - u, w - u), x - u); };
  const double at_p = volume(a, b, c, p);
  const double at_q = volume(a, b, c, q);
  constexpr double kSlack = 1e-10;
  if (!(at_p * at_q < 0) || std::abs(at_p) < kSlack || std::abs(at_q) < kSlack) return false;
  const double x = volume(p, q, a, b);
  const double y = volume(p, q, b, c);
  const double z = volume(p, q, c, a);
  return (x > kSlack && y > kSlack && z > kSlack) || (x < -kSlack && y < -kSlack && z < -kSlack);
}

int crossing_pairs(const SurfaceMesh& mesh) {
  int pairs = 0;
  const auto corner = [&](const Triangle& t, std::size_t n) { return mesh.points[t[n % 3]]; };
  for (const Triangle& s : mesh.triangles) {
    for (const Triangle& t : mesh.triangles) {
      for (std::size_t n = 0; n < 3; ++n) {
        if (pierces(corner(s, n), corner(s, n + 1), corner(t, 0), corner(t, 1), corner(t, 2))) ++pairs;
      }
    }
  }
  return pairs;
}

void expect_sound(const Isosurface& isosurface, const std::string& what) {
  const Topology topology = examine_topology(isosurface.surface);
  EXPECT_EQ(describe_violations(topology), "") << what;
  EXPECT_EQ(topology.unused_points, 0u) << what;
  EXPECT_GT(smallest_area(isosurface.surface), 1e-9) << what;
}

TEST(MarchingCubes, IsClosedAndManifoldOnNoiseWithTies) {
  const Context context;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const auto side = static_cast<std::int32_t>(3 + seed % 18);
    const Image image = noise({side, side + 1, side + 2}, 3 + seed % 4, seed);
    const Isosurface isosurface = marching_cubes(image, {.lower = 1}, {}, context);
    expect_sound(isosurface, "seed " + std::to_string(seed));
    EXPECT_GT(signed_volume(isosurface.surface), 0);
  }
}

TEST(MarchingCubes, KeepsTheLargestSurfacesAndTheirCells) {
  const Context context;
  const Image image = noise({17, 14, 12}, 5, 4);
  const Isosurface all = marching_cubes(image, {.lower = 3}, {}, context);
  const std::size_t components = examine_topology(all.surface).components;
  ASSERT_GT(components, 3u);
  std::size_t previous = 0;
  for (const std::uint32_t count : {1u, 2u, 3u}) {
    const Isosurface kept = marching_cubes(image, {.lower = 3}, {.keep = {count}}, context);
    expect_sound(kept, "keep " + std::to_string(count));
    EXPECT_EQ(examine_topology(kept.surface).components, count);
    EXPECT_GT(kept.surface.triangles.size(), previous);
    previous = kept.surface.triangles.size();
    std::size_t in_cells = 0;
    for (std::int32_t k = -1; k < image.frame.dims[2]; ++k) {
      for (std::int32_t j = -1; j < image.frame.dims[1]; ++j) {
        for (std::int32_t i = -1; i < image.frame.dims[0]; ++i) {
          const auto [begin, end] = kept.triangles_of_cell(i, j, k);
          for (Index t = begin; t < end; ++t, ++in_cells) {
            for (const Index v : kept.surface.triangles[t]) {
              const Vec3 local =
                  image.frame.to_index(kept.surface.points[v]) - Vec3{i + 0.5, j + 0.5, k + 0.5};
              EXPECT_LE(std::max({std::abs(local.x), std::abs(local.y), std::abs(local.z)}), 0.5 + 1e-9);
            }
          }
        }
      }
    }
    EXPECT_EQ(in_cells, previous);
  }
  const std::uint32_t more = static_cast<std::uint32_t>(components) + 5;
  EXPECT_EQ(marching_cubes(image, {.lower = 3}, {.keep = {more}}, context).surface.triangles,
            all.surface.triangles);
}

TEST(MarchingCubes, NeverCrossesItselfOnNoise) {
  const Context context;
  for (std::uint64_t seed = 1; seed <= 150; ++seed) {
    const Image image = noise({3, 4, 3}, seed % 3 == 0 ? 1u << 20 : 4, seed);
    const Isosurface isosurface =
        marching_cubes(image, {.lower = seed % 3 == 0 ? double(1 << 19) : 2}, {}, context);
    EXPECT_EQ(crossing_pairs(isosurface.surface), 0) << "seed " << seed;
  }
}

TEST(MarchingCubes, VolumeOfSphereInObliqueGrids) {
  for (const bool left_handed : {false, true}) {
    const GridFrame frame = oblique_frame({60, 40, 24}, left_handed);
    const Vec3 centre = frame.to_lps({29, 19.5, 11.7});
    const Image image = sampled(frame, [&](Vec3 p) { return 15 - distance(p, centre); });
    const Isosurface isosurface = marching_cubes(image, {.lower = 0}, {}, Context());
    expect_sound(isosurface, "sphere");
    const Topology topology = examine_topology(isosurface.surface);
    EXPECT_EQ(topology.euler, 2);
    const double exact = 4.0 / 3 * 3.14159265358979 * 15 * 15 * 15;
    EXPECT_NEAR(signed_volume(isosurface.surface), exact, 0.005 * exact);
  }
}

TEST(MarchingCubes, SameBitsForAnyNumberOfThreads) {
  Context two;
  two.threads = 2;
  const Image image = noise({70, 33, 41}, 5, 8);
  const Isosurface a = marching_cubes(image, {.lower = 2}, {}, Context());
  const Isosurface b = marching_cubes(image, {.lower = 2}, {}, two);
  EXPECT_EQ(a.surface.points, b.surface.points);
  EXPECT_EQ(a.surface.triangles, b.surface.triangles);
  EXPECT_EQ(a.block_table, b.block_table);
  ASSERT_EQ(a.blocks.size(), b.blocks.size());
  for (std::size_t n = 0; n < a.blocks.size(); ++n) EXPECT_EQ(a.blocks[n].first, b.blocks[n].first);
}

// An open surface ends on the planes through the border voxels' centres, and nowhere else.
TEST(MarchingCubes, OpenSurfacesEndOnTheBorder) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const Image image = noise({9, 8, 18}, 4, seed);
    const Isosurface isosurface = marching_cubes(image, {.lower = 2}, {.open = true}, Context());
    const Topology topology = examine_topology(isosurface.surface);
    EXPECT_TRUE(topology.is_manifold() && topology.is_oriented() && !topology.is_closed());
    const auto& mesh = isosurface.surface;
    const auto neighbours = triangle_neighbours(mesh.triangles, mesh.points.size());
    for (std::size_t t = 0; t < neighbours.size(); ++t) {
      for (std::size_t n = 0; n < 3; ++n) {
        if (neighbours[t][n] != kNoIndex) continue;
        const Vec3 a = image.frame.to_index(mesh.points[mesh.triangles[t][(n + 1) % 3]]);
        const Vec3 b = image.frame.to_index(mesh.points[mesh.triangles[t][(n + 2) % 3]]);
        double off = 1;  // voxels from the nearest border plane that holds both ends
        for (std::size_t axis = 0; axis < 3; ++axis) {
          for (const double plane : {0.0, image.frame.dims[axis] - 1.0}) {
            off = std::min(off, std::max(std::abs(a[axis] - plane), std::abs(b[axis] - plane)));
          }
        }
        EXPECT_LT(off, 1e-9);
      }
    }
  }
}

TEST(MarchingCubes, IsCappedHalfAVoxelOutsideTheBorder) {
  const Image image{GridFrame{{3, 4, 5}, {1, 2, 3}, {7, 8, 9}, {}}, std::vector<float>(60, 1000.0f)};
  const Isosurface isosurface = marching_cubes(image, {.lower = 226}, {}, Context());
  for (const Vec3 p : isosurface.surface.points) {
    const Vec3 x = image.frame.to_index(p);
    EXPECT_TRUE(x.x > -0.51 && x.y > -0.51 && x.z > -0.51 && x.x < 2.51 && x.y < 3.51 && x.z < 4.51);
  }
  expect_sound(isosurface, "full image");
  EXPECT_THROW(marching_cubes(image, {.lower = 226}, {.open = true}, Context()), Error);
  EXPECT_THROW(marching_cubes(image, {.lower = 2000}, {}, Context()), Error);
}

// What the mask did not touch stays where the grey values put it; a voxel held against them moves its surface
// to itself.
TEST(MarchingCubes, MaskKeepsUntouchedPartsSubvoxel) {
  Image image{GridFrame{{6, 1, 1}, {1, 1, 1}, {0, 0, 0}, {}}, {0, 0, 80, 80, 80, 0}};
  Mask mask{image.frame, {0, 0, 1, 1, 0, 0}, ThresholdRange{.lower = 60}};
  const auto span = [](const Isosurface& isosurface) {
    std::pair<double, double> ends{1e9, -1e9};
    for (const Vec3 p : isosurface.surface.points) {
      ends.first = std::min(ends.first, p.x);
      ends.second = std::max(ends.second, p.x);
    }
    return ends;
  };
  const auto [low, high] = span(marching_cubes(&image, mask, {}, Context()));
  EXPECT_NEAR(low, 1.75, 1e-6);
  EXPECT_NEAR(high, 3.98, 1e-6);
  mask.range.reset();
  const auto [low_mask, high_mask] = span(marching_cubes(&image, mask, {}, Context()));
  EXPECT_NEAR(low_mask, 1.5, 1e-6);
  EXPECT_NEAR(high_mask, 3.5, 1e-6);
}

TEST(MarchingCubes, RefusesAMaskOnAnotherGrid) {
  const Image image{GridFrame{{2, 2, 2}, {1, 1, 1}, {0, 0, 0}, {}}, std::vector<float>(8, 1.0f)};
  const Mask mask{GridFrame{{2, 2, 2}, {1, 1, 1}, {5, 0, 0}, {}}, std::vector<std::uint8_t>(8, 1),
                  ThresholdRange{}};
  EXPECT_THROW(marching_cubes(&image, mask, {}, Context()), Error);
}

}  // namespace
}  // namespace periost
