// The certified scheme from end to end on small isosurfaces: topology kept, no self-intersection, both
// distances within the tolerance by dense sampling, angles, determinism.
#include <gtest/gtest.h>

#include <algorithm>

#include "certified_shapes.h"
#include "pipeline/base/error.h"
#include "pipeline/geometry/isosurface_components.h"
#include "pipeline/geometry/isosurface_of_surface.h"
#include "pipeline/geometry/self_intersection.h"
#include "pipeline/geometry/simplex_dual.h"
#include "pipeline/geometry/simplex_geometry.h"
#include "pipeline/geometry/surface_distance.h"
#include "pipeline/geometry/topology.h"
#include "stages/decimate/certified.h"
#include "stages/decimate/certified_guard.h"
#include "stages/marching_cubes/marching_cubes.h"
#include "stages/phantom/phantom.h"

namespace periost {
namespace {

struct Case {
  std::string name;
  Isosurface (*make)();
  double distance;  // voxels
  double least_rate;
  double p01_angle, worst_angle;  // degrees
};

SurfaceMesh decimated(const Isosurface& isosurface, const DecimateOptions& options,
                      SimplexMesh* mesh = nullptr, int threads = 1) {
  Context context;
  context.threads = threads;
  SimplexMesh result = decimate_certified(isosurface, options, context);
  SurfaceMesh surface = dual_triangulation(result);
  if (mesh) *mesh = std::move(result);
  return surface;
}

// Upper bounds of both maximal distances, mm, by the project's own measure.
std::pair<double, double> distances(const SurfaceMesh& result, const Isosurface& isosurface) {
  const auto both = two_sided_distance(result, isosurface.surface, {}, Context{});
  return {both.forward.summary.max, both.backward.summary.max};
}

std::vector<double> sorted_angles(const SurfaceMesh& mesh) {
  std::vector<double> angles;
  for (const auto& [a, b, c] : mesh.triangles) {
    angles.push_back(min_angle({mesh.points[a], mesh.points[b], mesh.points[c]}) * 57.29577951308232);
  }
  std::sort(angles.begin(), angles.end());
  return angles;
}

// The smallest dihedral angle at an edge within the body, degrees.
double sharpest_edge(const SurfaceMesh& mesh) {
  const auto normal_of = [&](const Triangle& t) {
    return normalized(cross(mesh.points[t[1]] - mesh.points[t[0]], mesh.points[t[2]] - mesh.points[t[0]]));
  };
  const auto neighbours = triangle_neighbours(mesh.triangles, mesh.points.size());
  double smallest = 180;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vec3 n = normal_of(mesh.triangles[t]), here = mesh.points[mesh.triangles[t][0]];
    for (const Index across : neighbours[t]) {
      const Triangle& other = mesh.triangles[across];
      double height = 0;
      for (const Index v : other) height += dot(n, mesh.points[v] - here);
      if (height >= 0) continue;  // hollow
      const double bend = std::acos(std::clamp(dot(n, normal_of(other)), -1.0, 1.0));
      smallest = std::min(smallest, 180 - bend * 57.29577951308232);
    }
  }
  return smallest;
}

class Certified : public testing::TestWithParam<Case> {};

TEST_P(Certified, KeepsItsPromises) {
  const Isosurface isosurface = GetParam().make();
  DecimateOptions options;
  options.distance = Length::voxel(GetParam().distance);
  SimplexMesh mesh;
  const SurfaceMesh result = decimated(isosurface, options, &mesh);
  const Topology before = examine_topology(isosurface.surface), after = examine_topology(result);
  EXPECT_TRUE(after.is_closed());
  EXPECT_TRUE(after.is_manifold());
  EXPECT_TRUE(after.is_oriented());
  EXPECT_EQ(after.euler, before.euler);
  EXPECT_EQ(after.components, before.components);
  EXPECT_TRUE(self_intersections(result, Context{}).empty());
  EXPECT_EQ(check_simplex_mesh(mesh), "");
  const double tolerance = GetParam().distance * isosurface.frame.largest_spacing();
  const auto [forward, backward] = distances(result, isosurface);
  EXPECT_LE(forward, tolerance);
  EXPECT_LE(backward, tolerance);
  EXPECT_GE(mesh.report.rate(), GetParam().least_rate);
  EXPECT_EQ(mesh.report.triangles_after, result.triangles.size());
  EXPECT_EQ(mesh.report.triangles_before + 2 * mesh.report.insertions - 2 * mesh.report.removals,
            mesh.report.triangles_after);
  const auto angles = sorted_angles(result);
  EXPECT_GE(angles[angles.size() / 100], GetParam().p01_angle);
  EXPECT_GE(angles.front(), GetParam().worst_angle);
  EXPECT_EQ(mesh.face_fields.at("blocked_by").size(), mesh.dual_position.size());
  // No edge sharper than the limit where the isosurface has none.
  EXPECT_GE(sharpest_edge(result) + 1e-6,
            std::min(sharpest_edge(isosurface.surface), options.min_edge_angle.degrees));
}

INSTANTIATE_TEST_SUITE_P(
    Shapes, Certified,
    testing::Values(Case{"ellipsoid", [] { return shapes::ellipsoid(); }, 0.3, 0.88, 29.9, 29.5},
                    Case{"left_handed", [] { return shapes::ellipsoid(true); }, 0.3, 0.88, 29.9, 29.5},
                    Case{"tight", [] { return shapes::ellipsoid(); }, 0.05, 0.3, 20, 10},
                    Case{"stairs", shapes::stairs, 0.4, 0.75, 29.5, 29},
                    Case{"sheets", shapes::near_sheets, 0.3, 0.55, 15, 10},
                    Case{"noise", [] { return shapes::white_noise(1); }, 0.3, 0.15, 5, 0}),
    [](const auto& test) { return test.param.name; });

TEST(Certified, IsDeterministicForAnyNumberOfThreads) {
  const Isosurface isosurface = shapes::stairs();
  const SurfaceMesh one = decimated(isosurface, {}), two = decimated(isosurface, {}, nullptr, 2);
  EXPECT_EQ(one.points, two.points);
  EXPECT_EQ(one.triangles, two.triangles);
}

// Large enough to be cut into several regions, with sheets across the seams.
TEST(Certified, RegionsDoNotShowInTheResult) {
  const Isosurface isosurface = shapes::large_sheets();
  ASSERT_GT(isosurface.surface.points.size(), 6500u);  // more than one region
  DecimateOptions options;
  SimplexMesh mesh;
  const SurfaceMesh one = decimated(isosurface, options, &mesh),
                    four = decimated(isosurface, options, nullptr, 4);
  EXPECT_EQ(one.points, four.points);
  EXPECT_EQ(one.triangles, four.triangles);
  const Topology before = examine_topology(isosurface.surface), after = examine_topology(one);
  EXPECT_TRUE(after.is_closed());
  EXPECT_TRUE(after.is_manifold());
  EXPECT_EQ(after.euler, before.euler);
  EXPECT_EQ(check_simplex_mesh(mesh), "");
  EXPECT_TRUE(self_intersections(one, Context{}).empty());
  const double tolerance = options.distance.in_mm(isosurface.frame.largest_spacing());
  const auto [forward, backward] = distances(one, isosurface);
  EXPECT_LE(forward, tolerance);
  EXPECT_LE(backward, tolerance);
  const auto angles = sorted_angles(one);
  EXPECT_GE(angles[0], 20);
  EXPECT_GE(mesh.report.rate(), 0.85);
}

// The law of motion at work on the paper's binary cube: rms of the simplex angle against the mean of its
// neighbours.
TEST(Certified, RigidityBuysSmoothness) {
  const Isosurface isosurface =
      marching_cubes(make_phantom({.shape = PhantomShape::kCube}, {}), {.lower = 0.5}, {}, {});
  const auto roughness = [&](int rigidity, int iterations) {
    DecimateOptions options;
    options.distance = Length::voxel(0.4);
    options.rigidity = rigidity;
    options.stiffness = 0.15;
    options.iterations = iterations;
    const SurfaceMesh result = decimated(isosurface, options);
    const auto [forward, backward] = distances(result, isosurface);
    const double tolerance = options.distance.in_mm(isosurface.frame.largest_spacing());
    EXPECT_LE(std::max(forward, backward), tolerance);
    const SimplexMesh mesh = dual_simplex_mesh(result);
    double sum = 0;
    for (std::uint32_t v = 0; v < mesh.face.size(); ++v) {
      const auto angle = [&](SimplexVertex w) { return simplex_angle(simplex_parameters(mesh, w)); };
      double mean = 0;
      for (const SimplexVertex w : mesh.neighbour[v]) mean += angle(w) / 3;
      const double difference = angle(SimplexVertex{v}) - mean;
      sum += difference * difference;
    }
    return std::sqrt(sum / static_cast<double>(mesh.face.size()));
  };
  const double none = roughness(0, 5), rigid = roughness(3, 5);
  EXPECT_LT(rigid, 0.97 * none);
}

TEST(Certified, StopsAtACount) {
  const Isosurface isosurface = shapes::large_sheets();
  const std::size_t count = isosurface.surface.triangles.size();
  DecimateOptions options;
  options.max_triangles = count / 3;
  const SurfaceMesh result = decimated(isosurface, options);
  EXPECT_LE(result.triangles.size(), options.max_triangles);
  EXPECT_GE(result.triangles.size(), options.max_triangles * 93 / 100);
}

// A tube with rings of `around` vertices and a vertex at either end; vertex around * ring + i stands in a
// ring.
Isosurface ringed_tube(Index around, Index rings) {
  Isosurface tube{};
  tube.frame = shapes::oblique_frame({40, 40, 40});
  auto& points = tube.surface.points;
  auto& triangles = tube.surface.triangles;
  for (Index ring = 0; ring < rings; ++ring) {
    for (Index i = 0; i < around; ++i) {
      const double angle = 6.283185307179586 * i / around;
      points.push_back({-110 + 2 * std::cos(angle), 55 + 2 * std::sin(angle), 320 + 2.0 * ring});
    }
  }
  const Index bottom = around * rings, top = bottom + 1;
  points.push_back({-110, 55, 319});
  points.push_back({-110, 55, 319 + 2.0 * rings});
  for (Index i = 0; i < around; ++i) {
    const Index next = (i + 1) % around, last = around * (rings - 1);
    triangles.push_back({bottom, next, i});
    triangles.push_back({top, last + i, last + next});
    for (Index ring = 0; ring + 1 < rings; ++ring) {
      const Index a = around * ring + i, b = around * ring + next;
      triangles.push_back({a, b, b + around});
      triangles.push_back({a, b + around, a + around});
    }
  }
  return tube;
}

// Of the edges in the tube's middle, around it and along it.
struct NeckCounts {
  std::size_t around = 0, along = 0;  // removals that make a neck
  std::size_t proposed = 0;
};
NeckCounts count_necks(Index around) {
  const Reference reference(ringed_tube(around, 6));
  const CertifiedMesh mesh = make_certified_mesh(reference);
  NeckCounts counts;
  Proposal proposal;
  for (Index t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto& corner = mesh.triangles[t].corner;
      const Vec3 u = mesh.points[corner[(k + 1) % 3]], v = mesh.points[corner[(k + 2) % 3]];
      const double middle = (u.z + v.z) / 2;
      if (middle < 321 || middle > 329 || !propose_removal(mesh, t, k, proposal)) continue;
      ++counts.proposed;
      (std::abs(u.z - v.z) < 1 ? counts.around : counts.along) += makes_neck(mesh, proposal) ? 1 : 0;
    }
  }
  return counts;
}

TEST(Certified, ATubeOfFourEdgesAroundMayNotBecomeOneOfThree) {
  const NeckCounts four = count_necks(4);
  EXPECT_EQ(four.around, 32u);  // both ways along four edges of four rings
  EXPECT_EQ(four.along, 0u);
  EXPECT_GT(four.proposed, four.around);
  const NeckCounts five = count_necks(5);
  EXPECT_EQ(five.around + five.along, 0u);
  EXPECT_GT(five.proposed, 0u);
}

// T2^2 and T1^2 on the same place: what was there before, and the same neighbours.
TEST(Certified, InsertionIsTheInverseOfRemoval) {
  const Isosurface isosurface = shapes::ellipsoid();
  const Reference reference(isosurface);
  CertifiedMesh mesh = make_certified_mesh(reference);
  Proposal proposal;
  Index t = 100;
  while (!propose_removal(mesh, t, 0, proposal)) ++t;
  proposal.place = mesh.points[proposal.moved];
  proposal.place_nearest = mesh.nearest[proposal.moved];
  const Index vertex = proposal.removed;
  std::array<Index, 2> dead{kNoIndex, kNoIndex};
  std::size_t count = 0;
  for (const Index old : proposal.before) {
    if (!proposal.after.contains(old)) dead[count++] = old;
  }
  ASSERT_EQ(count, 2u);
  apply(proposal, mesh);
  const CertifiedMesh before = mesh;
  const Index edge = proposal.after[0];
  mesh.valence[vertex] = 0;
  ASSERT_TRUE(propose_insertion(mesh, edge, 0, vertex, dead, proposal));
  const auto c = mesh.triangles[edge].corner;
  proposal.place = (mesh.points[c[1]] + mesh.points[c[2]]) * 0.5;
  proposal.place_nearest = mesh.nearest[c[1]];
  apply(proposal, mesh);
  Star star;
  ASSERT_TRUE(gather_star(mesh, vertex, star));
  EXPECT_EQ(star.triangle.size(), 4u);
  EXPECT_EQ(mesh.valence[vertex], 4);
  // The inserted vertex is merged into the end of its edge again.
  for (std::size_t k = 0; k < 3; ++k) {
    const LinkedTriangle cell = mesh.triangles[edge];
    if (cell.corner[(k + 1) % 3] != c[1] || cell.corner[(k + 2) % 3] != vertex) continue;
    ASSERT_TRUE(propose_removal(mesh, edge, k, proposal));
    proposal.place = mesh.points[proposal.moved];
    proposal.place_nearest = mesh.nearest[proposal.moved];
    apply(proposal, mesh);
    break;
  }
  EXPECT_EQ(mesh.incident[vertex], kNoIndex);
  const auto corners = [](const CertifiedMesh& m) {
    std::vector<std::array<Index, 3>> all;
    for (const LinkedTriangle& triangle : m.triangles) {
      auto corner = triangle.corner;
      if (!triangle.is_alive()) continue;
      std::rotate(corner.begin(), std::min_element(corner.begin(), corner.end()), corner.end());
      all.push_back(corner);
    }
    std::sort(all.begin(), all.end());
    return all;
  };
  EXPECT_EQ(corners(mesh), corners(before));
  mesh.valence[vertex] = before.valence[vertex];
  EXPECT_EQ(mesh.valence, before.valence);
}

TEST(Certified, DropsSmallComponentsOnRequest) {
  const Isosurface isosurface = shapes::white_noise(2);
  DecimateOptions options;
  options.small_components = SmallComponents::kDrop;
  options.small_triangles = 60;
  Context context;
  const SimplexMesh mesh = decimate(isosurface, options, context);
  const SurfaceMesh result = dual_triangulation(mesh);
  const auto component = triangle_components(isosurface.surface.triangles, isosurface.surface.points.size());
  std::vector<int> size(examine_topology(isosurface.surface).components, 0);
  for (const auto c : component) ++size[c];
  const auto large = std::count_if(size.begin(), size.end(), [](int n) { return n >= 60; });
  ASSERT_GT(std::ptrdiff_t(size.size()), large);
  EXPECT_EQ(std::ptrdiff_t(examine_topology(result).components), large);
  EXPECT_EQ(mesh.report.triangles_before, isosurface.surface.triangles.size());
  EXPECT_EQ(mesh.report.dropped_below, 60u);

  // What is dropped proves nothing: the result is as if it had never been there, and near what is kept.
  Isosurface kept = isosurface;
  keep_largest_surfaces(kept, static_cast<std::uint32_t>(large));
  EXPECT_EQ(result.points, decimated(kept, {}).points);
  const auto [forward, backward] = distances(result, kept);
  EXPECT_LE(forward, 0.3 * isosurface.frame.largest_spacing());
  EXPECT_LE(backward, 0.3 * isosurface.frame.largest_spacing());
}

TEST(Certified, ASurfaceWithoutAnImageIsItsOwnReference) {
  const Isosurface with_voxels = shapes::ellipsoid();
  SurfaceMesh surface = with_voxels.surface;
  surface.voxel_mm = 0;
  const Isosurface isosurface = isosurface_of_surface(surface);
  EXPECT_FALSE(isosurface.has_voxels());
  EXPECT_FALSE(isosurface.is_open);
  DecimateOptions options;
  options.distance = Length::mm(0.3 * with_voxels.frame.largest_spacing());
  Context context;
  const SimplexMesh mesh = decimate(isosurface, options, context);
  EXPECT_GE(mesh.report.rate(), 0.85);
  const auto [forward, backward] = distances(dual_triangulation(mesh), isosurface);
  EXPECT_LE(forward, options.distance.value);
  EXPECT_LE(backward, options.distance.value);

  const auto refused = [&](auto&& change) {
    DecimateOptions asked = options;
    change(asked);
    try {
      decimate(isosurface, asked, context);
      return std::string("done");
    } catch (const Error& error) {
      return error.code();
    }
  };
  EXPECT_EQ(refused([](DecimateOptions& o) { o.distance = Length::voxel(0.3); }), "decimate.no_voxel");
  EXPECT_EQ(refused([](DecimateOptions& o) { o.max_edge = Length::voxel(3); }), "decimate.no_voxel");
  EXPECT_EQ(refused([](DecimateOptions& o) { o.method = DecimateMethod::kPaper; }), "decimate.no_voxel");
  EXPECT_EQ(refused([](DecimateOptions& o) { o.pieces = 3; }), "decimate.no_voxel");
  EXPECT_EQ(refused([](DecimateOptions& o) { o.edge_per_thickness = 1; }), "decimate.no_voxel");
}

TEST(Certified, WithoutReverseOnlyTheForwardDistanceHolds) {
  const Isosurface isosurface = shapes::ellipsoid();
  DecimateOptions options;
  options.reverse = ReverseDistance::kNone;
  const SurfaceMesh result = decimated(isosurface, options);
  const double tolerance = options.distance.in_mm(isosurface.frame.largest_spacing());
  EXPECT_LE(distances(result, isosurface).first, tolerance);
}

TEST(Certified, DecimatesTheRaggedContourOfAHole) {
  Isosurface isosurface = shapes::ellipsoid();
  auto& triangles = isosurface.surface.triangles;
  const Vec3 centre = isosurface.surface.points[triangles[triangles.size() / 2][0]];
  std::erase_if(triangles,
                [&](const Triangle& t) { return distance(isosurface.surface.points[t[0]], centre) < 3; });
  isosurface.is_open = true;
  const Topology before = examine_topology(isosurface.surface);
  if (!before.is_manifold()) GTEST_SKIP() << "the cut is pinched";
  const SurfaceMesh result = decimated(isosurface, {});
  const Topology after = examine_topology(result);
  EXPECT_TRUE(after.is_manifold());
  EXPECT_LT(after.violations(Violation::kBoundaryEdge), before.violations(Violation::kBoundaryEdge));
  EXPECT_GT(after.violations(Violation::kBoundaryEdge), 2u);
  EXPECT_EQ(after.euler, before.euler);
  EXPECT_LT(result.triangles.size(), triangles.size() / 2);
  const auto [forward, backward] = distances(result, isosurface);
  EXPECT_LE(forward, 0.3 * isosurface.frame.largest_spacing());
  EXPECT_LE(backward, 0.3 * isosurface.frame.largest_spacing());
}

}  // namespace
}  // namespace periost
