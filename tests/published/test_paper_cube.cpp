// The paper's first example (section 5, figure 4 b and c): a rotated cube full of steps, distance 40 % of the
// voxel, rigidity 3, stiffness 0.15. Published: a reduction of 90 %.
#include <gtest/gtest.h>

#include "pipeline/geometry/simplex_dual.h"
#include "stages/decimate/decimate.h"
#include "stages/marching_cubes/marching_cubes.h"
#include "stages/phantom/phantom.h"

namespace periost {
namespace {

TEST(PublishedCube, IsDecimatedByNinetyPercent) {
  Context context;
  PhantomOptions phantom;
  phantom.shape = PhantomShape::kCube;
  const Image image = make_phantom(phantom, context);
  const Isosurface isosurface = marching_cubes(image, {.lower = 0.5}, {}, context);
  EXPECT_NEAR(static_cast<double>(isosurface.surface.triangles.size()), 23204, 464);

  DecimateOptions options;
  options.method = DecimateMethod::kPaper;
  options.distance = Length::voxel(0.4);
  options.rigidity = 3;
  options.stiffness = 0.15;
  const SimplexMesh mesh = decimate(isosurface, options, context);
  EXPECT_EQ(check_simplex_mesh(mesh), "");
  EXPECT_EQ(euler_number(mesh), 2);
  RecordProperty("rate", std::to_string(mesh.report.rate()));
  std::printf("%llu triangles of %llu are left, a rate of %.2f %% (published: 90 %%)\n",
              static_cast<unsigned long long>(mesh.report.triangles_after),
              static_cast<unsigned long long>(mesh.report.triangles_before), 100 * mesh.report.rate());
  EXPECT_GE(mesh.report.rate(), 0.88);
  EXPECT_LE(mesh.report.rate(), 0.92);
}

}  // namespace
}  // namespace periost
