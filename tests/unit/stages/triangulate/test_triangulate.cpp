#include <gtest/gtest.h>

#include <limits>

#include "pipeline/base/error.h"
#include "pipeline/geometry/simplex_dual.h"
#include "pipeline/geometry/simplex_walk.h"
#include "stages/triangulate/triangulate.h"
#include "tests/support/surfaces.h"

namespace periost {
namespace {

double volume(const SurfaceMesh& mesh) {
  double sum = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    sum += dot(mesh.points[a], cross(mesh.points[b], mesh.points[c])) / 6;
  return sum;
}

TEST(Triangulate, TheDualOfAnUntouchedModelIsTheSurfaceItself) {
  SurfaceMesh torus = test::torus_surface(5, 2, 24, 12);
  torus.voxel_mm = 0.7;
  torus.point_fields["blocked_by"].assign(torus.points.size(), 3.0F);
  Context context;
  const SurfaceMesh surface = triangulate(dual_simplex_mesh(torus), {}, context);
  EXPECT_EQ(surface.points, torus.points);
  EXPECT_EQ(surface.triangles, torus.triangles);
  EXPECT_EQ(surface.point_fields, torus.point_fields);
  EXPECT_EQ(surface.voxel_mm, 0.7);
}

TEST(Triangulate, FaceCentresShrinkAConvexSurfaceALittleAndKeepItsOrientation) {
  const SurfaceMesh sphere = test::sphere_surface({10, -20, 30}, 5, 3);
  Context context;
  const SurfaceMesh centres = triangulate(dual_simplex_mesh(sphere), {DualPlace::kFaceCentre}, context);
  EXPECT_LT(volume(centres), volume(sphere));
  EXPECT_GT(volume(centres), 0.95 * volume(sphere));
}

TEST(Triangulate, ContoursKeepTheirPoints) {
  SurfaceMesh open = test::sphere_surface({0, 0, 0}, 5, 2);
  open.triangles.resize(open.triangles.size() / 2);
  const SimplexMesh mesh = dual_simplex_mesh(open);
  Context context;
  const SurfaceMesh centres = triangulate(mesh, {DualPlace::kFaceCentre}, context);
  std::size_t border = 0;
  for (std::uint32_t f = 0; f < mesh.valence.size(); ++f) {
    const bool on_border = is_border(mesh, SimplexFace{f});
    border += on_border ? 1 : 0;
    EXPECT_EQ(centres.points[f] == mesh.dual_position[f], on_border);
  }
  EXPECT_GT(border, 0u);
}

TEST(Triangulate, NothingAndNotANumberAreRefused) {
  Context context;
  EXPECT_THROW(triangulate(SimplexMesh(), {}, context), Error);
  SimplexMesh mesh = dual_simplex_mesh(test::tetrahedron_surface());
  mesh.dual_position[2].y = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(triangulate(mesh, {}, context), Error);
}

}  // namespace
}  // namespace periost
