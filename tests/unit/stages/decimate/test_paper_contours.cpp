// Open surfaces under `method: paper`, in an oblique anisotropic grid off the origin.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "pipeline/geometry/isosurface_contour.h"
#include "pipeline/geometry/isosurface_cut.h"
#include "pipeline/geometry/isosurface_query.h"
#include "pipeline/geometry/simplex_dual.h"
#include "pipeline/geometry/topology.h"
#include "stages/decimate/contour_model.h"
#include "stages/decimate/decimate.h"
#include "stages/marching_cubes/marching_cubes.h"
#include "tests/unit/stages/decimate/open_shapes.h"
#include "tests/unit/stages/decimate/paper_decimation.h"

namespace periost {
namespace {

using test::paper_options;

// Where depth(p) >= 0, p in voxels; the surface is open at the image border.
template <class Depth>
Isosurface open_shape(std::array<std::int32_t, 3> dims, Depth depth, bool left_handed = false) {
  return shapes::open_shape({-31, 12, 55}, dims, depth, left_handed);
}

// A tube that leaves through both ends of axis k, stepped like a mask.
Isosurface tube() {
  return open_shape({27, 27, 30}, [](Vec3 p) { return std::hypot(p.x - 13, p.y - 13) <= 9.4 ? 1 : -1; });
}
// A ball around a corner of the image: one contour over three planes.
Isosurface corner() {
  return open_shape(
      {24, 24, 24},
      [](Vec3 p) {
        return 17.3 - norm(p - Vec3{2, 1, 3});
      },
      true);
}

struct Border {
  std::vector<Vec3> points;
  std::size_t edges = 0;
  std::map<Index, int> ends;
};

Border border_of(const SurfaceMesh& surface) {
  Border border;
  const auto neighbours = triangle_neighbours(surface.triangles, surface.points.size());
  for (std::size_t t = 0; t < neighbours.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (neighbours[t][k] != kNoIndex) continue;
      ++border.edges;
      for (const std::size_t e : {1u, 2u}) {
        const Index p = surface.triangles[t][(k + e) % 3];
        if (++border.ends[p] == 1) border.points.push_back(surface.points[p]);
      }
    }
  }
  return border;
}

// How far p lies off the nearest border plane, in voxels.
double off_border_planes(const GridFrame& frame, Vec3 p) {
  const Vec3 index = frame.to_index(p);
  double off = 1e9;
  for (std::size_t a = 0; a < 3; ++a)
    off = std::min({off, std::abs(index[a]), std::abs(index[a] - (frame.dims[a] - 1))});
  return off;
}

class OpenSurfaces : public testing::TestWithParam<Isosurface (*)()> {};

TEST_P(OpenSurfaces, KeepContoursOnTheBorderPlanesWithinTheDistanceWithFewerEdges) {
  const Isosurface isosurface = GetParam()();
  Context context;
  const SimplexMesh mesh = decimate(isosurface, paper_options(), context);
  EXPECT_EQ(check_simplex_mesh(mesh), "");
  EXPECT_GT(mesh.report.rate(), 0.7);
  EXPECT_EQ(mesh.report.triangles_after, mesh.face.size());
  EXPECT_EQ(euler_number(mesh), euler_number(dual_simplex_mesh(isosurface.surface)));
  const SurfaceMesh surface = dual_triangulation(mesh);
  const Topology topology = examine_topology(surface);
  EXPECT_TRUE(topology.is_manifold());
  EXPECT_TRUE(topology.is_oriented());

  const Border before = border_of(isosurface.surface), after = border_of(surface);
  EXPECT_LT(after.edges, 0.5 * static_cast<double>(before.edges));
  EXPECT_GE(after.edges, 6u);
  const auto open = open_sides(isosurface.surface);
  const double tolerance = 0.4 * 1.3;
  for (const Vec3 p : after.points) {
    EXPECT_LT(off_border_planes(isosurface.frame, p), 1e-9);
    const auto closest = closest_on_contour(isosurface, open, p, {}, 3 * tolerance);
    ASSERT_TRUE(closest);
    EXPECT_LE(closest->distance, tolerance * (1 + 1e-9));
  }
  // Criteria inside hold as on closed surfaces.
  for (const Vec3 p : mesh.position) {
    const auto closest = closest_point(isosurface, p, 3 * tolerance);
    ASSERT_TRUE(closest);
    EXPECT_LE(closest->distance, tolerance * (1 + 1e-9));
  }
}

TEST_P(OpenSurfaces, GiveTheSameBitsOnAnyNumberOfThreads) {
  const Isosurface isosurface = GetParam()();
  Context one, two;
  two.threads = 2;
  const SimplexMesh a = decimate(isosurface, paper_options(), one),
                    b = decimate(isosurface, paper_options(), two);
  EXPECT_EQ(a.position, b.position);
  EXPECT_EQ(a.face, b.face);
  EXPECT_EQ(a.dual_position, b.dual_position);
}

INSTANTIATE_TEST_SUITE_P(Shapes, OpenSurfaces, testing::Values(&tube, &corner));

TEST(Contours, APointInACornerOfTheImageStaysWhereItIs) {
  const Isosurface isosurface = corner();
  Context context;
  const SurfaceMesh surface = dual_triangulation(decimate(isosurface, paper_options(), context));
  // The ball meets three edges of the image, each in one point.
  std::vector<Vec3> corners;
  for (const Vec3 p : border_of(isosurface.surface).points) {
    const Vec3 index = isosurface.frame.to_index(p);
    const int planes = (std::abs(index.x) < 1e-9) + (std::abs(index.y) < 1e-9) + (std::abs(index.z) < 1e-9);
    if (planes == 2) corners.push_back(p);
  }
  ASSERT_EQ(corners.size(), 3u);
  for (const Vec3 p : corners)
    EXPECT_NE(std::find(surface.points.begin(), surface.points.end(), p), surface.points.end());
}

TEST(Contours, AreSmoothedByTheirRigidity) {
  // The stepped circle of the tube's end: turning angles between border edges.
  const auto roughness = [](int rigidity) {
    DecimateOptions options = paper_options();
    options.rigidity = rigidity;
    options.stiffness = 0.15;
    Context context;
    const Isosurface isosurface = tube();
    const SurfaceMesh surface = dual_triangulation(decimate(isosurface, options, context));
    const Vec3 middle = isosurface.frame.to_lps({13, 13, 0});
    double sum = 0, squares = 0, count = 0;
    for (const Vec3 p : border_of(surface).points) {
      if (std::abs(isosurface.frame.to_index(p).z) > 0.5) continue;
      const Vec3 index = isosurface.frame.to_index(p) - isosurface.frame.to_index(middle);
      const double radius = std::hypot(index.x, index.y);
      sum += radius;
      squares += radius * radius;
      ++count;
    }
    return std::sqrt(std::max(0.0, squares / count - sum * sum / count / count));
  };
  EXPECT_LT(roughness(3), 0.35);
  EXPECT_LT(roughness(3), roughness(0));
}

TEST(Contours, AContourInsideTheImageIsKeptBitByBit) {
  const Isosurface half = cut_part(tube(), {2, {15}}, 0);
  Context context;
  const SimplexMesh mesh = decimate(half, paper_options(), context);
  EXPECT_EQ(check_simplex_mesh(mesh), "");
  EXPECT_GT(mesh.report.rate(), 0.6);
  const auto on_cut = [&](const SurfaceMesh& surface) {
    std::vector<std::array<double, 3>> points;
    for (const Vec3 p : border_of(surface).points) {
      if (std::abs(half.frame.to_index(p).z - 15) < 1e-6) points.push_back({p.x, p.y, p.z});
    }
    std::sort(points.begin(), points.end());
    return points;
  };
  EXPECT_EQ(on_cut(dual_triangulation(mesh)), on_cut(half.surface));
  EXPECT_GT(on_cut(half.surface).size(), 40u);
}

TEST(ContourParameters, FollowACircle) {
  // Four points on a circle: sin(phi) = (|AB| / 2) / R at each, and L(phi) gives the height back.
  const Isosurface isosurface = tube();
  SimplexMesh mesh = dual_simplex_mesh(isosurface.surface);
  const Contours contours = close_contours(mesh, isosurface.frame);
  const ContourModel model = contour_model(isosurface, contours);
  std::size_t tested = 0;
  for (std::uint32_t i = 0; i < mesh.face.size(); ++i) {
    const SimplexVertex v{i};
    if (!contours.is_on_contour(v)) continue;
    const Vec3 centre = isosurface.frame.to_lps({13, 13, contours.side[i] == 4 ? 0.0 : 29.0});
    const double radius = 7.5;
    for (const SimplexVertex x : {v, mesh.neighbour[i][0], mesh.neighbour[i][1]}) {
      mesh.position[index_of(x)] = centre + radius * normalized(mesh.position[index_of(x)] - centre);
    }
    const SimplexParameters s = contour_parameters(model, mesh, v);
    ASSERT_FALSE(s.is_degenerate);
    EXPECT_NEAR(s.barycentric[0] + s.barycentric[1], 1, 1e-12);
    EXPECT_NEAR(std::sin(simplex_angle(s)), s.circumradius / radius, 1e-9);
    EXPECT_NEAR(height_at_angle(simplex_angle(s), s.power, s.circumradius), s.height, 1e-9);
    EXPECT_GT(s.height, 0) << "outside is convex";
    ++tested;
  }
  EXPECT_GT(tested, 50u);
}

}  // namespace
}  // namespace periost
