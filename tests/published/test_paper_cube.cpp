// The paper's first example (section 5, figure 4 b and c): a rotated cube full of steps, distance 40 % of the
// voxel, rigidity 3, stiffness 0.15. Published: a reduction of 90 %, and a surface without steps.
#include <gtest/gtest.h>

#include "pipeline/geometry/measure_surface.h"
#include "pipeline/geometry/simplex_dual.h"
#include "tests/published/published.h"

namespace periost {
namespace {

TEST(PublishedCube, IsDecimatedByNinetyPercentAndRigidityMakesItSmooth) {
  const Isosurface isosurface = test::phantom_isosurface(PhantomShape::kCube, 0.5);
  EXPECT_NEAR(static_cast<double>(isosurface.surface.triangles.size()), 23204, 464);

  DecimateOptions options = test::paper_options(0.4);
  options.rigidity = 3;
  options.stiffness = 0.15;
  const SimplexMesh mesh = test::decimated(isosurface, options);
  EXPECT_EQ(check_simplex_mesh(mesh), "");
  EXPECT_EQ(euler_number(mesh), 2);
  RecordProperty("rate", std::to_string(mesh.report.rate()));
  test::print_rate("cube", mesh, "90 %");
  EXPECT_GE(mesh.report.rate(), 0.88);
  EXPECT_LE(mesh.report.rate(), 0.92);

  options.rigidity = 0;
  const SurfaceMesh rigid = dual_triangulation(mesh),
                    loose = dual_triangulation(test::decimated(isosurface, options));
  const double angle = *simplex_angle_rms_deg(rigid), angle_loose = *simplex_angle_rms_deg(loose);
  const double normal = normal_deviation_rms_deg(rigid), normal_loose = normal_deviation_rms_deg(loose);
  std::printf("smoothness at rigidity 3 and 0: simplex angle %.2f and %.2f deg, normals %.2f and %.2f deg\n",
              angle, angle_loose, normal, normal_loose);
  EXPECT_LT(angle, 0.97 * angle_loose);
  EXPECT_LT(normal, 0.97 * normal_loose);
}

}  // namespace
}  // namespace periost
