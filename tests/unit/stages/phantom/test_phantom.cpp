#include "stages/phantom/phantom.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "pipeline/base/error.h"
#include "pipeline/geometry/topology.h"
#include "stages/marching_cubes/marching_cubes.h"
#include "stages/threshold/threshold.h"

namespace periost {
namespace {

constexpr double kPi = 3.14159265358979323846;

struct Known {
  PhantomShape shape;
  double lower;
  double noise;
  std::size_t triangles;
  std::int64_t euler;
};

// The threshold of each shape's documentation finds the surface that the documentation promises.
TEST(Phantom, ShapesHaveTheirTriangles) {
  const Known rows[] = {
      {PhantomShape::kCube, 0.5, 0, 23204, 2},      {PhantomShape::kVentricle, 0.5, 0, 40000, 4},
      {PhantomShape::kVentricle, 0.5, 1, 42424, 2}, {PhantomShape::kVessel, 190, 0, 126000, 4},
      {PhantomShape::kTorus, 500, 0, 26944, 0},     {PhantomShape::kSheets, 500, 0, 66864, 10}};
  for (const Known& row : rows) {
    const Image image = make_phantom({.shape = row.shape, .noise = row.noise}, {});
    const Isosurface isosurface = marching_cubes(image, {.lower = row.lower}, {}, Context());
    const Topology topology = examine_topology(isosurface.surface);
    EXPECT_EQ(describe_violations(topology), "");
    EXPECT_NEAR(static_cast<double>(topology.triangles), static_cast<double>(row.triangles),
                0.03 * static_cast<double>(row.triangles));
    EXPECT_EQ(topology.euler, row.euler) << row.triangles;
  }
}

TEST(Phantom, SameBitsForAnyNumberOfThreads) {
  Context two;
  two.threads = 2;
  for (int n = 0; n <= static_cast<int>(PhantomShape::kSheets); ++n) {
    PhantomOptions options{
        .shape = static_cast<PhantomShape>(n), .size = {{40, 44, 48}}, .noise = 0.5, .seed = 3};
    const Image one = make_phantom(options, {});
    EXPECT_EQ(one.values, make_phantom(options, two).values) << n;
    options.seed = 4;
    EXPECT_NE(one.values, make_phantom(options, {}).values) << n;
  }
}

TEST(Phantom, SphereAndTorusEncloseTheirVolumeInAnyFrame) {
  const double c = std::cos(0.4);
  const double s = std::sin(0.4);
  for (const double hand : {1.0, -1.0}) {
    PhantomOptions options{.shape = PhantomShape::kSphere,
                           .size = {{70, 60, 30}},
                           .spacing = Vec3{0.8, 1.0, 2.0},
                           .origin = {-100, 20, 300},
                           .direction = {c, s, 0, -s, c, 0, 0, 0, hand},
                           .radius = 20};
    const Image ball = make_phantom(options, {});
    const double ball_volume = signed_volume(marching_cubes(ball, {.lower = 500}, {}, Context()).surface);
    EXPECT_NEAR(ball_volume, 4.0 / 3 * kPi * 8000, 0.01 * 4.0 / 3 * kPi * 8000);
    options.shape = PhantomShape::kTorus;
    options.radius = 16;
    const Image ring = make_phantom(options, {});
    const double exact = 2 * kPi * kPi * 16 * 6.4 * 6.4;
    EXPECT_NEAR(signed_volume(marching_cubes(ring, {.lower = 500}, {}, Context()).surface), exact,
                0.015 * exact);
  }
}

TEST(Phantom, FemurHasTheTissuesOfAThigh) {
  const Image image = make_phantom({.shape = PhantomShape::kFemur}, {});
  const auto& frame = image.frame;
  const auto [low, high] = std::minmax_element(image.values.begin(), image.values.end());
  EXPECT_GE(*low, -50);
  EXPECT_LE(*high, 1800);
  EXPECT_GE(*high, 1600);
  EXPECT_EQ(image.values[0], 40);
  // Across the middle of the shaft: muscle, cortex, marrow, cortex, muscle.
  std::string tissues;
  for (std::int32_t i = 0; i < frame.dims[0]; ++i) {
    const float value = image.values[frame.offset(i, frame.dims[1] / 2 + 7, frame.dims[2] / 2)];
    const char tissue = value > 1100 ? 'c' : value == 40 ? 'o' : value < 101 ? 'm' : ' ';
    if (tissue != ' ' && (tissues.empty() || tissues.back() != tissue)) tissues += tissue;
  }
  EXPECT_EQ(tissues, "ocmco");
  // Solid once its cavities are filled.
  const Mask mask = threshold(image, {.lower = 226, .keep = {1}}, {});
  const Topology topology = examine_topology(marching_cubes(&image, mask, {}, Context()).surface);
  EXPECT_EQ(topology.components, 1u);
  EXPECT_EQ(topology.euler, 2);
}

TEST(Phantom, NoiseHasTies) {
  const Image image = make_phantom({.shape = PhantomShape::kNoise}, {});
  EXPECT_EQ(std::set<float>(image.values.begin(), image.values.end()),
            (std::set<float>{0, 1, 2, 3, 4, 5, 6, 7}));
}

TEST(Phantom, RefusesFramesThatAreNone) {
  EXPECT_THROW(make_phantom({.size = {{0, 4, 4}}}, {}), Error);
  EXPECT_THROW(make_phantom({.size = {{1 << 30, 1 << 30, 4}}}, {}), Error);
  EXPECT_THROW(make_phantom({.spacing = Vec3{1, -1, 1}}, {}), Error);
  EXPECT_THROW(make_phantom({.direction = {1, 0, 0, 1, 0, 0, 0, 0, 1}}, {}), Error);
}

}  // namespace
}  // namespace periost
