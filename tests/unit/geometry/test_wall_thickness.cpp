#include "pipeline/geometry/wall_thickness.h"

#include <gtest/gtest.h>

#include "tests/support/rigid_motion.h"
#include "tests/support/surfaces.h"

namespace periost {
namespace {

TEST(WallThickness, IsThatOfAPlateWhereverItLies) {
  SurfaceMesh plate = test::box_surface({0, 0, 0}, {10, 8, 0.5});
  const Vec3 inside{4, 3, 0.1}, outside{4, 3, 0.9};
  EXPECT_NEAR(wall_thickness(plate, inside, 2).value(), 0.5, 1e-12);
  EXPECT_FALSE(wall_thickness(plate, outside, 2));
  for (Vec3& p : plate.points) p = test::moved(p, 0.7, 1);
  EXPECT_NEAR(wall_thickness(plate, test::moved(inside, 0.7, 1), 2).value(), 0.5, 1e-9);
  EXPECT_FALSE(wall_thickness(plate, test::moved(outside, 0.7, 1), 2));
}

TEST(WallThickness, IsNoneWhereTheOtherSideIsFar) {
  const SurfaceMesh box = test::box_surface({0, 0, 0}, {10, 8, 6});
  EXPECT_FALSE(wall_thickness(box, {4, 3, 0.1}, 2));
  EXPECT_FALSE(wall_thickness(box, {4, 3, 3}, 2));
}

}  // namespace
}  // namespace periost
