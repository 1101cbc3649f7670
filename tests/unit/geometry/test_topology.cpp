#include "pipeline/geometry/topology.h"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/support/surfaces.h"

namespace periost {
namespace {

using test::box_surface;
using test::joined;
using test::sphere_surface;
using test::tetrahedron_surface;
using test::torus_surface;

TEST(Topology, ClosedSurfacesAreClosedManifoldAndOriented) {
  const struct {
    SurfaceMesh mesh;
    std::int64_t euler;
    std::uint32_t components;
  } cases[] = {{tetrahedron_surface(), 2, 1},
               {box_surface({-3, 2, 5}, {4, 4, 9}), 2, 1},
               {sphere_surface({10, -20, 30}, 4, 3), 2, 1},
               {torus_surface(5, 2, 24, 12), 0, 1},
               {joined(torus_surface(5, 2, 24, 12), sphere_surface({}, 1, 1)), 2, 2}};
  for (const auto& c : cases) {
    const Topology topology = examine_topology(c.mesh);
    EXPECT_TRUE(topology.is_closed() && topology.is_manifold() && topology.is_oriented());
    EXPECT_EQ(topology.euler, c.euler);
    EXPECT_EQ(topology.components, c.components);
    EXPECT_EQ(topology.unused_points, 0u);
    EXPECT_EQ(describe_violations(topology), "");
    EXPECT_GT(signed_volume(c.mesh), 0);
  }
}

TEST(Topology, VolumeAndAreaAreThoseOfTheShape) {
  const SurfaceMesh box = box_surface({100, -7, 3}, {104, -5, 8});
  EXPECT_NEAR(signed_volume(box), 4 * 2 * 5, 1e-11);
  EXPECT_NEAR(surface_area(box), 2 * (4 * 2 + 2 * 5 + 4 * 5), 1e-12);
  const SurfaceMesh sphere = sphere_surface({1e3, 2e3, -3e3}, 2, 5);
  EXPECT_NEAR(signed_volume(sphere), 4.0 / 3 * std::numbers::pi * 8, 0.02);
  SurfaceMesh inverted = box;
  for (Triangle& t : inverted.triangles) std::swap(t[1], t[2]);
  EXPECT_NEAR(signed_volume(inverted), -40, 1e-11);
}

TEST(Topology, AHoleIsNamedWithItsPlace) {
  SurfaceMesh box = box_surface({0, 0, 0}, {1, 1, 1});
  box.triangles.erase(box.triangles.begin());  // 0, 2, 1 of the bottom
  const Topology topology = examine_topology(box);
  EXPECT_FALSE(topology.is_closed());
  EXPECT_TRUE(topology.is_manifold());
  EXPECT_EQ(topology.violations(Violation::kBoundaryEdge), 3u);
  EXPECT_EQ(topology.euler, 1);
  ASSERT_EQ(topology.places.size(), 3u);
  EXPECT_EQ(topology.places[0].place_mm, (Vec3{0.5, 0, 0}));
  EXPECT_EQ(describe_violations(topology), "3 boundary edges, the first at (0.500, 0.000, 0.000) mm");
}

TEST(Topology, BranchesPinchesAndTwistsAreTold) {
  SurfaceMesh branch = box_surface({0, 0, 0}, {1, 1, 1});
  branch.points.push_back({-1, -1, -1});
  branch.triangles.push_back({0, 1, 8});
  EXPECT_EQ(examine_topology(branch).violations(Violation::kNonManifoldEdge), 1u);

  // Two tetrahedra that touch in one point.
  SurfaceMesh pinch = joined(tetrahedron_surface(), tetrahedron_surface());
  for (Triangle& t : pinch.triangles) {
    for (Index& corner : t) corner = corner == 4 ? 0 : corner;
  }
  const Topology pinched = examine_topology(pinch);
  EXPECT_EQ(pinched.violations(Violation::kPinchedVertex), 1u);
  EXPECT_EQ(pinched.unused_points, 1u);
  EXPECT_EQ(pinched.components, 2u);
  EXPECT_FALSE(pinched.is_manifold());

  SurfaceMesh twist = box_surface({0, 0, 0}, {1, 1, 1});
  std::swap(twist.triangles[3][0], twist.triangles[3][1]);
  EXPECT_EQ(examine_topology(twist).violations(Violation::kMisorientedEdge), 3u);
  EXPECT_FALSE(examine_topology(twist).is_oriented());

  SurfaceMesh degenerate = tetrahedron_surface();
  degenerate.triangles.push_back({1, 1, 2});
  degenerate.points.push_back({std::nan(""), 0, 0});
  const Topology bad = examine_topology(degenerate);
  EXPECT_EQ(bad.violations(Violation::kDegenerateTriangle), 1u);
  EXPECT_EQ(bad.violations(Violation::kNonFinitePoint), 1u);
}

TEST(Topology, OnlyAFewPlacesAreKept) {
  SurfaceMesh soup;
  for (Index t = 0; t < 100; ++t) {
    for (const Vec3 p : {Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}}) soup.points.push_back(p);
    soup.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  const Topology topology = examine_topology(soup, 4);
  EXPECT_EQ(topology.violations(Violation::kBoundaryEdge), 300u);
  EXPECT_EQ(topology.places.size(), 4u);
  EXPECT_EQ(topology.components, 100u);
}

TEST(Topology, NeighboursAreMutualAndOppositeToTheirCorner) {
  const SurfaceMesh mesh = torus_surface(3, 1, 9, 7);
  const auto neighbours = triangle_neighbours(mesh.triangles, mesh.points.size());
  for (Index t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Index other = neighbours[t][k];
      ASSERT_NE(other, kNoIndex);
      EXPECT_NE(std::find(neighbours[other].begin(), neighbours[other].end(), t), neighbours[other].end());
      const Triangle& corners = mesh.triangles[other];
      EXPECT_EQ(std::find(corners.begin(), corners.end(), mesh.triangles[t][k]), corners.end());
    }
  }
  SurfaceMesh open = box_surface({0, 0, 0}, {1, 1, 1});
  open.triangles.pop_back();
  const auto beside = triangle_neighbours(open.triangles, open.points.size());
  int missing = 0;
  for (const auto& n : beside) missing += static_cast<int>(std::count(n.begin(), n.end(), kNoIndex));
  EXPECT_EQ(missing, 3);
}

TEST(Topology, ValencesSumToTwiceTheEdges) {
  const SurfaceMesh mesh = sphere_surface({}, 1, 2);
  std::uint64_t sum = 0;
  for (const std::uint32_t valence : point_valences(mesh.triangles, mesh.points.size())) {
    EXPECT_TRUE(valence == 5 || valence == 6);
    sum += valence;
  }
  EXPECT_EQ(sum, 2 * examine_topology(mesh).edges);
}

TEST(Topology, RenumberingChangesNothing) {
  const SurfaceMesh mesh = joined(torus_surface(5, 2, 11, 8), box_surface({20, 0, 0}, {21, 1, 1}));
  SurfaceMesh other = mesh;
  std::reverse(other.points.begin(), other.points.end());
  std::reverse(other.triangles.begin(), other.triangles.end());
  for (Triangle& t : other.triangles) {
    for (Index& corner : t) corner = static_cast<Index>(mesh.points.size() - 1 - corner);
    std::rotate(t.begin(), t.begin() + 1, t.end());
  }
  const Topology a = examine_topology(mesh), b = examine_topology(other);
  EXPECT_EQ(a.euler, b.euler);
  EXPECT_EQ(a.components, b.components);
  EXPECT_EQ(a.count, b.count);
  EXPECT_NEAR(signed_volume(mesh), signed_volume(other), 1e-10);
}

TEST(Topology, AnEmptySurfaceIsNotClosed) {
  const Topology topology = examine_topology(SurfaceMesh{});
  EXPECT_FALSE(topology.is_closed());
  EXPECT_EQ(topology.components, 0u);
}

}  // namespace
}  // namespace periost
