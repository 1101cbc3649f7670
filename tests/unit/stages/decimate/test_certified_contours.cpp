// Open surfaces under `method: certified`: contours that end on the image border, in an oblique anisotropic
// grid off the origin.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "pipeline/base/random.h"
#include "pipeline/geometry/isosurface_cut.h"
#include "pipeline/geometry/self_intersection.h"
#include "pipeline/geometry/simplex_dual.h"
#include "pipeline/geometry/surface_distance.h"
#include "pipeline/geometry/topology.h"
#include "stages/decimate/certified.h"
#include "stages/decimate/certified_guard.h"
#include "stages/marching_cubes/marching_cubes.h"
#include "tests/unit/stages/decimate/open_shapes.h"

namespace periost::certified_contours_test {
namespace {

constexpr double kVoxels = 0.3;

// Where depth(p) >= 0, p in voxels; the surface is open at the image border.
template <class Depth>
Isosurface open_shape(std::array<std::int32_t, 3> dims, Depth depth, bool left_handed = false) {
  return shapes::open_shape({-310, 120, 55}, dims, depth, left_handed);
}

// A smooth bent tube that leaves through both ends of axis k.
Isosurface tube() {
  return open_shape({40, 36, 30}, [](Vec3 p) {
    return 11 - std::hypot(p.x - 19.6 - 2 * std::sin(0.15 * p.z), p.y - 17.3);
  });
}
// The same with steps, as of a mask.
Isosurface stepped_tube() {
  return open_shape({27, 27, 30}, [](Vec3 p) { return std::hypot(p.x - 13, p.y - 13) <= 9.4 ? 1 : -1; });
}
// A ball around a corner of the image: one contour over three planes.
Isosurface corner() {
  return open_shape(
      {32, 32, 32},
      [](Vec3 p) {
        return 23.3 - norm(p - Vec3{2, 1, 3});
      },
      true);
}
// Two sheets near each other that leave on all four sides.
Isosurface sheets() {
  return open_shape({36, 36, 14}, [](Vec3 p) {
    const double z = p.z - 6.5 + 1.2 * std::sin(0.2 * p.x) * std::cos(0.17 * p.y);
    return 0.6 - std::min(std::abs(z - 1.1), std::abs(z + 1.1));
  });
}
Isosurface noise() {
  Random random(7, 0);
  return open_shape({9, 8, 9}, [&](Vec3) { return random.uniform() - 0.5; });
}
// A contour away from the image border: no plane holds it.
Isosurface half_tube() {
  Isosurface half = cut_part(tube(), {2, {15}}, 0);
  half.frame.dims = {64, 64, 64};
  half.frame.origin = half.frame.to_lps({-9.5, -9.5, -9.5});
  return half;
}

using Segment = std::array<Vec3, 2>;
struct Border {
  std::vector<Segment> edges;
  std::size_t loops = 0;
};
Border border_of(const SurfaceMesh& surface) {
  Border border;
  std::map<Index, Index> next;
  const auto neighbours = triangle_neighbours(surface.triangles, surface.points.size());
  for (std::size_t t = 0; t < neighbours.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (neighbours[t][k] != kNoIndex) continue;
      const Index a = surface.triangles[t][(k + 1) % 3], b = surface.triangles[t][(k + 2) % 3];
      border.edges.push_back({surface.points[a], surface.points[b]});
      next[a] = b;
    }
  }
  std::set<Index> seen;
  for (const auto& [start, after] : next) {
    if (seen.count(start)) continue;
    ++border.loops;
    for (Index v = start; seen.insert(v).second;) v = next.at(v);
  }
  return border;
}

// The greatest distance of points of `from`, many on each edge, to the edges of `to`.
double farthest(const Border& from, const Border& to) {
  constexpr int kSamples = 12;
  double worst = 0;
  for (const Segment& s : from.edges) {
    for (int i = 0; i < kSamples; ++i) {
      const Vec3 p = s[0] + (s[1] - s[0]) * (double(i) / kSamples);
      double least = 1e300;
      for (const Segment& e : to.edges) {
        const Vec3 d = e[1] - e[0];
        const double part = std::clamp(dot(p - e[0], d) / squared_norm(d), 0.0, 1.0);
        least = std::min(least, squared_norm(p - e[0] - d * part));
      }
      worst = std::max(worst, least);
    }
  }
  return std::sqrt(worst);
}

int planes_of(const GridFrame& frame, Vec3 p, double within) {
  const Vec3 index = frame.to_index(p);
  int planes = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    planes += std::abs(index[a]) <= within ? 1 : 0;
    planes += std::abs(index[a] - (frame.dims[a] - 1)) <= within ? 1 : 0;
  }
  return planes;
}

SurfaceMesh decimated(const Isosurface& isosurface, SimplexMesh* mesh = nullptr, int threads = 1) {
  Context context;
  context.threads = threads;
  DecimateOptions options;
  options.distance = Length::voxel(kVoxels);
  SimplexMesh result = decimate_certified(isosurface, options, context);
  SurfaceMesh surface = dual_triangulation(result);
  if (mesh) *mesh = std::move(result);
  return surface;
}

struct Case {
  std::string name;
  Isosurface (*make)();
  double least_rate;
  double most_border;  // contour edges left, of those before
  bool on_planes;
};

class CertifiedOpenSurfaces : public testing::TestWithParam<Case> {};

TEST_P(CertifiedOpenSurfaces, KeepTheirPromises) {
  const Isosurface isosurface = GetParam().make();
  SimplexMesh mesh;
  const SurfaceMesh result = decimated(isosurface, &mesh);
  EXPECT_EQ(check_simplex_mesh(mesh), "");
  const Topology before = examine_topology(isosurface.surface), after = examine_topology(result);
  EXPECT_TRUE(after.is_manifold());
  EXPECT_TRUE(after.is_oriented());
  EXPECT_EQ(after.euler, before.euler);
  EXPECT_EQ(after.components, before.components);
  EXPECT_TRUE(self_intersections(result, Context{}).empty());

  const double tolerance = kVoxels * isosurface.frame.largest_spacing();
  const auto distances = two_sided_distance(result, isosurface.surface, {}, Context{});
  EXPECT_LE(distances.forward.summary.max, tolerance);
  EXPECT_LE(distances.backward.summary.max, tolerance);
  const Border old_border = border_of(isosurface.surface), border = border_of(result);
  EXPECT_EQ(border.loops, old_border.loops);
  EXPECT_LE(farthest(border, old_border), tolerance);
  EXPECT_LE(farthest(old_border, border), tolerance);
  if (GetParam().on_planes) {
    for (const Segment& edge : border.edges) {
      EXPECT_GE(planes_of(isosurface.frame, edge[0], 1e-9), 1);
      EXPECT_GE(planes_of(isosurface.frame, (edge[0] + edge[1]) * 0.5, 1e-9), 1);
    }
  }
  EXPECT_GE(mesh.report.rate(), GetParam().least_rate);
  EXPECT_LE(static_cast<double>(border.edges.size()),
            GetParam().most_border * static_cast<double>(old_border.edges.size()));
}

// Root mean square of what the curvature at the vertices of an isosurface's decimated contours differs from a
// circle's by, 1/voxel.
double contour_roughness(const Isosurface& isosurface, const SurfaceMesh& decimated, double radius) {
  const auto precedes = [](const Vec3& a, const Vec3& b) {
    return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
  };
  std::map<Vec3, std::vector<Vec3>, decltype(precedes)> ways(precedes);  // from each vertex to its neighbours
  for (const Segment& edge : border_of(decimated).edges) {
    const Vec3 a = isosurface.frame.to_index(edge[0]), b = isosurface.frame.to_index(edge[1]);
    ways[edge[0]].push_back(b - a);
    ways[edge[1]].push_back(a - b);
  }
  double squares = 0;
  for (const auto& [vertex, way] : ways) {
    const double cosine = -dot(normalized(way[0]), normalized(way[1]));
    const double turn = std::acos(std::clamp(cosine, -1.0, 1.0));
    squares += std::pow(2 * turn / (norm(way[0]) + norm(way[1])) - 1 / radius, 2);
  }
  return std::sqrt(squares / static_cast<double>(ways.size()));
}

TEST(CertifiedContourPoints, AreSmoothedByTheLawOfMotion) {
  // Within 0.2 voxel the steps stay; at 0.3 decimation alone takes them away.
  const Isosurface isosurface = stepped_tube();
  const auto roughness = [&](int iterations) {
    DecimateOptions options;
    options.distance = Length::voxel(0.2);
    options.iterations = iterations;
    options.rigidity = 3;
    options.stiffness = 0.15;
    Context context;
    const SurfaceMesh result = dual_triangulation(decimate_certified(isosurface, options, context));
    return contour_roughness(isosurface, result, 9.4);
  };
  EXPECT_LT(roughness(10), 0.9 * roughness(0));
}

TEST(CertifiedContourPoints, SmallOpenComponentsMayBeDropped) {
  const Isosurface isosurface = noise();
  Context context;
  DecimateOptions options;
  options.small_components = SmallComponents::kDrop;
  options.small_triangles = 200;
  const SurfaceMesh result = dual_triangulation(decimate(isosurface, options, context));
  const Topology topology = examine_topology(result);
  EXPECT_TRUE(topology.is_manifold());
  EXPECT_GE(topology.components, 1u);
  EXPECT_LT(topology.components, examine_topology(isosurface.surface).components);
}

TEST(CertifiedContourPoints, HaveTheSameBitsOnAnyNumberOfThreads) {
  for (const auto& [isosurface, threads] : {std::pair{sheets(), 4}, std::pair{corner(), 2}}) {
    const SurfaceMesh one = decimated(isosurface, nullptr, 1),
                      other = decimated(isosurface, nullptr, threads);
    EXPECT_EQ(one.points, other.points);
    EXPECT_EQ(one.triangles, other.triangles);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Shapes, CertifiedOpenSurfaces,
    testing::Values(Case{"tube", &tube, 0.9, 0.3, true}, Case{"stepped_tube", &stepped_tube, 0.6, 0.5, true},
                    Case{"corner", &corner, 0.9, 0.3, true}, Case{"sheets", &sheets, 0.8, 0.3, true},
                    Case{"noise", &noise, 0.0, 1.0, true}, Case{"half_tube", &half_tube, 0.9, 0.3, false}),
    [](const auto& shape) { return shape.param.name; });

TEST(CertifiedContourPoints, APointInACornerOfTheImageStaysWhereItIs) {
  const Isosurface isosurface = corner();
  const SurfaceMesh result = decimated(isosurface);
  // The ball meets three edges of the image, each in one point.
  std::vector<Vec3> corners;
  for (const Segment& edge : border_of(isosurface.surface).edges) {
    if (planes_of(isosurface.frame, edge[0], 1e-6) == 2) corners.push_back(edge[0]);
  }
  ASSERT_EQ(corners.size(), 3u);
  for (const Vec3 p : corners)
    EXPECT_NE(std::find(result.points.begin(), result.points.end(), p), result.points.end());
}

}  // namespace
}  // namespace periost::certified_contours_test
