// The guard against self-intersections, and where it watches.
#include <gtest/gtest.h>

#include "certified_shapes.h"
#include "stages/decimate/certified_sheets.h"

namespace periost {
namespace {

constexpr double kMiddle = 13.5;

// A plate of 2 voxels, or 2.6 mm, thickness.
Isosurface plate() {
  return shapes::isosurface_of({28, 28, 20}, [](Vec3 p) {
    return std::min(
        {1.0 - std::abs(p.z - 9.4), 10.2 - std::abs(p.x - kMiddle), 10.2 - std::abs(p.y - kMiddle)});
  });
}

Vec3 centroid_in_voxels(const Reference& reference, Index t) {
  const auto c = reference.corners(t);
  return reference.frame().to_index((c[0] + c[1] + c[2]) / 3);
}

bool is_on_a_face(Vec3 p) {
  return std::abs(p.x - kMiddle) < 7 && std::abs(p.y - kMiddle) < 7;
}

TEST(CloseSheets, APlateIsCloseToItselfWithinItsThickness) {
  const Reference reference(plate());
  std::size_t faces = 0;
  for (Index t = 0; t < reference.triangles.size(); ++t) {
    faces += is_on_a_face(centroid_in_voxels(reference, t)) ? 1 : 0;
  }
  ASSERT_GT(faces, 100U);
  const auto on_faces = [&](double gap) {
    std::size_t count = 0;
    for (const Index t : close_sheets(reference, gap, Context{})) {
      count += is_on_a_face(centroid_in_voxels(reference, t)) ? 1 : 0;
    }
    return count;
  };
  EXPECT_EQ(on_faces(1.0), 0U);  // triangles are up to 1 mm from their centroids
  EXPECT_EQ(on_faces(2.7), faces);
}

TEST(CloseSheets, AreTheSameOnAnyNumberOfThreads) {
  const Reference reference(shapes::near_sheets());
  Context four;
  four.threads = 4;
  EXPECT_EQ(close_sheets(reference, 0.5, Context{}), close_sheets(reference, 0.5, four));
}

// A vertex in the middle of the plate's upper face is moved through the lower one.
class WatchedPlate : public testing::Test {
 protected:
  Reference reference{plate()};
  CertifiedMesh mesh = make_certified_mesh(reference);
  Proposal proposal;
  SheetScratch scratch;

  void SetUp() override {
    Index middle = kNoIndex;
    double least = 1e300;
    for (Index v = 0; v < mesh.points.size(); ++v) {
      const Vec3 p = reference.frame().to_index(mesh.points[v]);
      const double off = squared_norm(p - Vec3{kMiddle, kMiddle, 10.4});
      if (off < least) {
        least = off;
        middle = v;
      }
    }
    ASSERT_TRUE(propose_relocation(mesh, middle, proposal));
    proposal.place = mesh.points[middle] - Vec3{0, 0, 3.2};
  }
  bool is_seen(SheetGrid grid) {
    grid.approach(mesh, proposal, scratch);
    return grid.would_intersect(mesh, proposal, {}, scratch);
  }
};

TEST_F(WatchedPlate, AnIntersectionIsSeenEverywhereOrWhereSheetsAreClose) {
  EXPECT_TRUE(is_seen(SheetGrid(reference, mesh, 2)));
  EXPECT_TRUE(is_seen(SheetGrid(reference, mesh, 2, close_sheets(reference, 2.7, Context{}), 0)));
}

TEST_F(WatchedPlate, NoIntersectionIsSeenWhereNothingIsWatched) {
  EXPECT_FALSE(is_seen(SheetGrid(reference, mesh, 2, {}, 0)));
}

TEST_F(WatchedPlate, AMoveThatStaysOnItsSideIsClear) {
  proposal.place = mesh.points[proposal.moved] - Vec3{0, 0, 1};
  EXPECT_FALSE(is_seen(SheetGrid(reference, mesh, 2)));
}

}  // namespace
}  // namespace periost
