#include "stages/read_surface/read_surface.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/base/error.h"
#include "pipeline/geometry/topology.h"
#include "pipeline/io/surface_write.h"
#include "tests/support/process.h"
#include "tests/support/surfaces.h"

namespace periost {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class ReadSurface : public testing::Test {
 protected:
  ReadSurface() {
    context_.sink = [this](const Event& event) { codes_.push_back(event.code); };
  }
  std::filesystem::path written(const SurfaceMesh& mesh, const char* name = "a.ply") {
    write_surface(mesh, folder_.path() / name);
    return folder_.path() / name;
  }
  SurfaceMesh read(const ReadSurfaceOptions& options) { return read_surface(options, context_); }
  // The code of the error; its sentence is kept in said_.
  std::string refused(const ReadSurfaceOptions& options) {
    try {
      read(options);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kInput);
      said_ = error.what();
      return error.code();
    }
    return "";
  }

  test::TemporaryFolder folder_;
  Context context_;
  std::vector<std::string> codes_;
  std::string said_;
};

TEST_F(ReadSurface, AClosedSurfaceIsTakenAsItIs) {
  const SurfaceMesh sphere = test::sphere_surface({120, -40, 900}, 20, 2);
  const SurfaceMesh read_back = read({written(sphere)});
  EXPECT_EQ(read_back.points, sphere.points);
  EXPECT_EQ(read_back.triangles, sphere.triangles);
  EXPECT_TRUE(read_back.was_read);
  EXPECT_THAT(codes_, ElementsAre("surface.read"));
}

TEST_F(ReadSurface, AnStlOfLooseFacetsIsClosedAgain) {
  const SurfaceMesh sphere = test::sphere_surface({120, -40, 900}, 20, 2);
  const SurfaceMesh read_back = read({written(sphere, "a.STL")});
  EXPECT_EQ(read_back.points.size(), sphere.points.size());
  EXPECT_EQ(read_back.triangles.size(), sphere.triangles.size());
}

TEST_F(ReadSurface, UnitsScaleAndRasTurns) {
  const SurfaceMesh box = test::box_surface({1, 2, 3}, {2, 4, 6});
  const auto path = written(box);
  struct Row {
    SurfaceUnit unit;
    double mm;
  };
  for (const Row row : {Row{SurfaceUnit::kMicrometre, 1e-3}, Row{SurfaceUnit::kMillimetre, 1},
                        Row{SurfaceUnit::kCentimetre, 10}, Row{SurfaceUnit::kMetre, 1000}}) {
    const SurfaceMesh scaled = read({path, row.unit, SurfaceFrame::kRas});
    EXPECT_NEAR(signed_volume(scaled), 6 * row.mm * row.mm * row.mm, 1e-9 * row.mm * row.mm * row.mm);
    EXPECT_NEAR(distance(scaled.points[7], row.mm * Vec3{-2, -4, 6}), 0, 1e-12 * row.mm);
  }
  // 3 um is no size of an organ; 3 m just passes.
  EXPECT_THAT(codes_, ElementsAre("surface.unit", "surface.read", "surface.read", "surface.read"));
}

TEST_F(ReadSurface, NormalsThatPointInwardAreTurned) {
  SurfaceMesh box = test::box_surface({1, 2, 3}, {2, 4, 6});
  for (Triangle& t : box.triangles) std::swap(t[0], t[1]);
  const auto path = written(box);
  EXPECT_NEAR(signed_volume(read({path})), 6, 1e-12);
  EXPECT_THAT(codes_, ElementsAre("surface.turned", "surface.read"));
  ReadSurfaceOptions any{path};
  any.require = SurfaceRequirement::kAny;
  EXPECT_NEAR(signed_volume(read(any)), -6, 1e-12);
}

TEST_F(ReadSurface, AnOpenSurfaceIsRefusedWithItsPlaceInMillimetres) {
  SurfaceMesh box = test::box_surface({1, 2, 3}, {2, 4, 6});
  box.triangles.pop_back();
  ReadSurfaceOptions options{written(box), SurfaceUnit::kCentimetre};
  EXPECT_EQ(refused(options), "surface.open");
  EXPECT_THAT(said_, HasSubstr("3 boundary edges, the first at (20.000, 30.000, 45.000) mm"));
  options.require = SurfaceRequirement::kAny;
  EXPECT_EQ(read(options).triangles.size(), 11u);
}

TEST_F(ReadSurface, OtherFaultsHaveTheirOwnCodes) {
  SurfaceMesh misoriented = test::box_surface({1, 2, 3}, {2, 4, 6});
  std::swap(misoriented.triangles[0][0], misoriented.triangles[0][1]);
  EXPECT_EQ(refused({written(misoriented)}), "surface.misoriented");

  const SurfaceMesh edge_shared =
      test::joined(test::box_surface({0, 0, 0}, {1, 1, 1}), test::box_surface({1, 1, 0}, {2, 2, 1}));
  EXPECT_EQ(refused({written(edge_shared)}), "surface.not_manifold");
  const SurfaceMesh corner_shared =
      test::joined(test::box_surface({0, 0, 0}, {1, 1, 1}), test::box_surface({1, 1, 1}, {2, 2, 2}));
  EXPECT_EQ(refused({written(corner_shared)}), "surface.not_manifold");
  EXPECT_THAT(said_, HasSubstr("pinched vertex, at (1.000, 1.000, 1.000) mm"));
}

TEST_F(ReadSurface, CoordinatesThatAreNoNumbersAreRefusedEvenWhenAnythingGoes) {
  ReadSurfaceOptions any;
  any.require = SurfaceRequirement::kAny;
  any.path = folder_.write("nan.off", "OFF\n3 1 0\n0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n");
  EXPECT_EQ(refused(any), "surface.not_finite");
  EXPECT_THAT(said_, HasSubstr("nan.off:4"));
  any.path = folder_.write("far.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1e306 0\n3 0 1 2\n");
  any.unit = SurfaceUnit::kMetre;
  EXPECT_EQ(refused(any), "surface.not_finite");
  EXPECT_THAT(said_, HasSubstr("point 2"));
  any.path = folder_.write("index.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n");
  EXPECT_EQ(refused(any), "surface.bad_index");
  EXPECT_THAT(said_, HasSubstr("index.off:6: a face names vertex 7 of 3"));
}

TEST_F(ReadSurface, SelfIntersectionsAreLeftToLaterStages) {
  const SurfaceMesh crossing =
      test::joined(test::sphere_surface({0, 0, 0}, 10, 1), test::sphere_surface({7, 3, 1}, 10, 1));
  EXPECT_EQ(read({written(crossing)}).triangles.size(), crossing.triangles.size());
}

TEST_F(ReadSurface, TheEstimateOfTrianglesIsAnUpperOne) {
  const SurfaceMesh sphere = test::sphere_surface({120, -40, 900}, 20, 3);
  for (const char* name : {"a.stl", "a.ply", "a.obj", "a.off", "a.vtp"}) {
    EXPECT_GE(estimate_triangles(written(sphere, name)), sphere.triangles.size()) << name;
  }
  EXPECT_EQ(estimate_triangles(folder_.path() / "absent.stl"), 0u);
}

}  // namespace
}  // namespace periost
