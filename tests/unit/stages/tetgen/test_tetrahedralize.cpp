#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <limits>

#include "pipeline/base/error.h"
#include "pipeline/geometry/tet_faces.h"
#include "stages/tetgen/tetgen.h"
#include "tests/support/fit_for_mechanics.h"
#include "tests/support/process.h"
#include "tests/support/surfaces.h"
#include "tests/unit/stages/tetgen/worker_context.h"

namespace periost {
namespace {

using test::enclosed_volume;
using test::inverted;
using test::joined;
using test::sphere_surface;
using test::worker_context;

double volume_of(const TetMesh& mesh, std::int32_t region = 0) {
  double sum = 0;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    const auto& [a, b, c, d] = mesh.tets[t];
    if (region != 0 && mesh.region[t] != region) continue;
    sum += six_volumes(mesh.points[a], mesh.points[b], mesh.points[c], mesh.points[d]) / 6;
  }
  return sum;
}

// What holds for every result that kept its surface.
void expect_sound(const TetMesh& mesh, const SurfaceMesh& surface) {
  ASSERT_FALSE(mesh.tets.empty());
  EXPECT_TRUE(mesh.boundary_preserved);
  EXPECT_EQ(mesh.boundary.size(), surface.triangles.size());
  EXPECT_TRUE(std::equal(surface.points.begin(), surface.points.end(), mesh.points.begin()));
  for (const auto& [a, b, c, d] : mesh.tets) {
    ASSERT_GT(six_volumes(mesh.points[a], mesh.points[b], mesh.points[c], mesh.points[d]), 0);
  }
  const double enclosed = enclosed_volume(surface);
  EXPECT_NEAR(volume_of(mesh), enclosed, 1e-9 * enclosed);
  SurfaceMesh boundary;
  boundary.points = mesh.points;
  boundary.triangles = mesh.boundary;
  EXPECT_NEAR(enclosed_volume(boundary), enclosed, 1e-9 * enclosed) << "boundary outward";
  test::expect_fit_for_mechanics(mesh);
}

ErrorKind kind_of_failure(const SurfaceMesh& surface, const TetgenOptions& options, const Context& context,
                          std::string* code = nullptr, std::string* text = nullptr) {
  try {
    tetrahedralize(surface, options, context);
  } catch (const Error& error) {
    if (code != nullptr) *code = error.code();
    if (text != nullptr) *text = error.what();
    return error.kind();
  }
  ADD_FAILURE() << "no error";
  return ErrorKind::kInternal;
}

TEST(Tetrahedralize, SphereFarFromTheOrigin) {
  const SurfaceMesh surface = sphere_surface({812.3, -455.1, 1020.7}, 30, 3);
  const TetMesh mesh = tetrahedralize(surface, {}, worker_context());
  expect_sound(mesh, surface);
  EXPECT_THAT(mesh.region, testing::Each(1));
  EXPECT_EQ(mesh.order(), 1);
}

TEST(Tetrahedralize, HollowSphere) {
  const SurfaceMesh surface =
      joined(sphere_surface({5, 6, 7}, 10, 3), inverted(sphere_surface({5, 6, 7.5}, 6, 2)));
  const TetMesh mesh = tetrahedralize(surface, {}, worker_context());
  expect_sound(mesh, surface);
  EXPECT_THAT(mesh.region, testing::Each(1));
}

TEST(Tetrahedralize, BodyInACavityOfABodyAndOneBeside) {
  const SurfaceMesh outer = sphere_surface({0, 0, 0}, 10, 3),
                    cavity = inverted(sphere_surface({0, 0, 0}, 8, 3));
  const SurfaceMesh inner = sphere_surface({1, 0, 0}, 5, 2), core = inverted(sphere_surface({1, 0, 0}, 2, 2));
  const SurfaceMesh beside = sphere_surface({30, 0, 0}, 4, 2);
  const SurfaceMesh surface = joined(joined(joined(joined(beside, cavity), outer), core), inner);
  const TetMesh mesh = tetrahedralize(surface, {}, worker_context());
  expect_sound(mesh, surface);
  const double volumes[] = {enclosed_volume(beside), enclosed_volume(outer) + enclosed_volume(cavity),
                            enclosed_volume(inner) + enclosed_volume(core)};
  for (std::int32_t body = 1; body <= 3; ++body) {
    const double volume = volumes[body - 1];
    EXPECT_NEAR(volume_of(mesh, body), volume, 1e-9 * volume) << body;
  }
}

TEST(Tetrahedralize, FilledCavitiesAreRegionsThatShareTheirWalls) {
  const SurfaceMesh outer = sphere_surface({100, 0, 0}, 10, 3),
                    cavity = inverted(sphere_surface({100, 0, 0}, 8, 3));
  const SurfaceMesh inner = sphere_surface({101, 0, 0}, 5, 2),
                    core = inverted(sphere_surface({101, 0, 0}, 2, 2));
  const SurfaceMesh beside = sphere_surface({130, 0, 0}, 4, 2);
  const SurfaceMesh surface = joined(joined(joined(joined(beside, cavity), outer), core), inner);
  TetgenOptions options;
  options.cavities = Cavities::kFilled;
  const TetMesh mesh = tetrahedralize(surface, options, worker_context());
  // The three bodies as above, then the two cavities in the order of their walls.
  const double volumes[] = {enclosed_volume(beside), enclosed_volume(outer) + enclosed_volume(cavity),
                            enclosed_volume(inner) + enclosed_volume(core),
                            -enclosed_volume(cavity) - enclosed_volume(inner), -enclosed_volume(core)};
  for (std::int32_t region = 1; region <= 5; ++region) {
    EXPECT_NEAR(volume_of(mesh, region), volumes[region - 1], 1e-9 * volumes[region - 1]) << region;
  }
  EXPECT_TRUE(mesh.boundary_preserved) << "walls inside count, too";
  EXPECT_EQ(mesh.boundary.size(), outer.triangles.size() + beside.triangles.size());
}

TEST(Tetrahedralize, NestingDecidesWhateverTheNormalsSay) {
  const SurfaceMesh outer = sphere_surface({0, 0, 0}, 10, 2), cavity = sphere_surface({0, 0, 0}, 8, 2);
  const TetMesh mesh = tetrahedralize(joined(outer, cavity), {}, worker_context());
  const double expected = enclosed_volume(outer) - enclosed_volume(cavity);
  EXPECT_NEAR(volume_of(mesh), expected, 1e-9 * expected);
}

TEST(Tetrahedralize, PointsThatNoTriangleUsesAreLeftOut) {
  SurfaceMesh surface = sphere_surface({0, 0, 0}, 10, 1);
  surface.points.insert(surface.points.begin(), Vec3{500, 0, 0});
  for (Triangle& t : surface.triangles) {
    for (Index& corner : t) ++corner;
  }
  const TetMesh mesh = tetrahedralize(surface, {}, worker_context());
  EXPECT_TRUE(std::equal(surface.points.begin() + 1, surface.points.end(), mesh.points.begin()));
  EXPECT_TRUE(mesh.boundary_preserved);
}

TEST(Tetrahedralize, SecondOrderNodesLieInTheMiddleOfVtksEdges) {
  TetgenOptions options;
  options.order = 2;
  const TetMesh mesh = tetrahedralize(sphere_surface({1, 2, 3}, 10, 2), options, worker_context());
  ASSERT_EQ(mesh.order(), 2);
  ASSERT_EQ(mesh.midside.size(), mesh.tets.size());
  constexpr std::size_t kEdges[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    for (std::size_t k = 0; k < 6; ++k) {
      const Vec3 a = mesh.points[mesh.tets[t][kEdges[k][0]]], b = mesh.points[mesh.tets[t][kEdges[k][1]]];
      ASSERT_LT(distance(mesh.points[mesh.midside[t][k]], 0.5 * (a + b)), 1e-12);
    }
  }
  std::set<std::pair<Index, Index>> edges;
  for (const Tetrahedron& tet : mesh.tets) {
    for (const auto& [a, b] : kEdges) edges.insert(std::minmax(tet[a], tet[b]));
  }
  std::set<Index> corners;
  for (const Tetrahedron& tet : mesh.tets) corners.insert(tet.begin(), tet.end());
  EXPECT_EQ(mesh.points.size(), corners.size() + edges.size()) << "nodes are shared";
}

TEST(Tetrahedralize, SameBitsTwice) {
  const SurfaceMesh surface = sphere_surface({3, 3, 3}, 10, 3);
  Context context = worker_context();
  const TetMesh first = tetrahedralize(surface, {}, context);
  context.threads = 2;
  const TetMesh second = tetrahedralize(surface, {}, context);
  EXPECT_EQ(first.points, second.points);
  EXPECT_EQ(first.tets, second.tets);
  EXPECT_EQ(first.boundary, second.boundary);
}

TEST(Tetrahedralize, MaximalVolumeHolds) {
  const SurfaceMesh surface = sphere_surface({0, 0, 0}, 10, 3);
  TetgenOptions options;
  options.max_volume = 2;
  const TetMesh mesh = tetrahedralize(surface, options, worker_context());
  double largest = 0;
  for (const auto& [a, b, c, d] : mesh.tets) {
    largest =
        std::max(largest, six_volumes(mesh.points[a], mesh.points[b], mesh.points[c], mesh.points[d]) / 6);
  }
  EXPECT_LE(largest, 3) << "TetGen's optimisation at the end may exceed it somewhat";
  EXPECT_GT(mesh.tets.size(), 2000U);
}

TEST(Tetrahedralize, SurfaceMayBeSplitWhenAskedAndThatIsSaid) {
  TetgenOptions options;
  options.preserve_surface = false;
  options.max_volume = 0.001;
  const SurfaceMesh surface = test::box_surface({10, 10, 10}, {11, 11, 11});
  const TetMesh mesh = tetrahedralize(surface, options, worker_context());
  EXPECT_FALSE(mesh.boundary_preserved);
  EXPECT_GT(mesh.boundary.size(), surface.triangles.size());
  EXPECT_NEAR(volume_of(mesh), 1, 1e-9);
  EXPECT_THAT(mesh.region, testing::Each(1));
}

struct BadSurface {
  const char* code;
  SurfaceMesh surface;
};

std::vector<BadSurface> bad_surfaces() {
  const SurfaceMesh good = sphere_surface({0, 0, 0}, 10, 2);
  std::vector<BadSurface> all;
  all.push_back({"surface.empty", {}});
  all.push_back({"surface.open", good});
  all.back().surface.triangles.pop_back();
  all.push_back({"surface.not_finite", good});
  all.back().surface.points[7].y = std::numeric_limits<double>::quiet_NaN();
  all.push_back({"surface.misoriented", good});
  std::swap(all.back().surface.triangles[3][0], all.back().surface.triangles[3][1]);
  all.push_back({"surface.not_manifold", good});
  all.back().surface.triangles[5][1] = 4000000;
  all.push_back({"surface.self_intersection", joined(good, sphere_surface({12, 0, 0}, 8, 2))});
  all.push_back({"surface.self_intersection", joined(good, good)});
  all.push_back({"surface.degenerate", test::box_surface({0, 0, 0}, {0, 1, 1})});
  return all;
}

TEST(Tetrahedralize, UnusableSurfacesAreRefusedByWhoMadeThem) {
  for (BadSurface& bad : bad_surfaces()) {
    std::string code;
    EXPECT_EQ(kind_of_failure(bad.surface, {}, worker_context(), &code), ErrorKind::kQuality);
    EXPECT_EQ(code, bad.code);
    bad.surface.was_read = true;
    EXPECT_EQ(kind_of_failure(bad.surface, {}, worker_context()), ErrorKind::kInput);
  }
}

TEST(Tetrahedralize, FaultsAreNamedAndDrawn) {
  const test::TemporaryFolder folder;
  Context context = worker_context();
  context.output = folder.path();
  std::string text;
  kind_of_failure(joined(sphere_surface({100, 0, 0}, 10, 2), sphere_surface({112, 0, 0}, 8, 2)), {}, context,
                  nullptr, &text);
  EXPECT_THAT(text, testing::HasSubstr("pairs of triangles, near ("));
  EXPECT_THAT(text, testing::HasSubstr("surface_faults.vtp"));
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "surface_faults.vtp"));
  EXPECT_THAT(test::partial_files(folder.path()), testing::IsEmpty());
}

}  // namespace
}  // namespace periost
