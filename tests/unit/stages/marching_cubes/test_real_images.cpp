// Triangle counts on real images: the table of PERIOST_TEST_DATA's README, and the skull that Debian
// packages.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <vector>

#include "pipeline/geometry/topology.h"
#include "pipeline/io/image_read.h"
#include "stages/marching_cubes/marching_cubes.h"
#include "stages/threshold/threshold.h"

namespace periost {
namespace {

namespace fs = std::filesystem;

// Counted by an extractor that leaves surfaces open at the image border, so these are extracted open too.
struct Row {
  const char* file;
  ThresholdRange range;
  std::size_t triangles;
  bool touches_border;
};

const Row kRows[] = {
    {"femur_leg_ct.nii.gz", {.lower = 226}, 112210, true},
    {"verse004_vertebrae_mask.nii.gz", {.lower = 0.5}, 191340, false},
    {"verse004_vertebrae_mask.nii.gz", {.lower = 19, .upper = 19}, 19920, false},
    {"verse004_vertebrae_mask.nii.gz", {.lower = 24, .upper = 24}, 25936, false},
    {"lateral_ventricles_1mm.nii.gz", {.lower = 0.5}, 40352, false},
    {"totalseg_torso_ct_3mm.nii.gz", {.lower = 226}, 120950, true},
    {"engine_256x256x128.nii.gz", {.lower = 80}, 586304, true},
};

TEST(RealImages, TriangleCountsAreTheKnownOnes) {
  const char* folder = std::getenv("PERIOST_TEST_DATA");
  if (folder == nullptr || !fs::exists(folder)) GTEST_SKIP() << "PERIOST_TEST_DATA names no folder";
  for (const Row& row : kRows) {
    const Image image = read_image(fs::path(folder) / row.file);
    const Isosurface open = marching_cubes(image, row.range, {.open = true}, Context());
    const auto expected = static_cast<double>(row.triangles);
    EXPECT_NEAR(static_cast<double>(open.surface.triangles.size()), expected, 0.01 * expected) << row.file;
    const Topology topology = examine_topology(open.surface);
    EXPECT_TRUE(topology.is_manifold() && topology.is_oriented()) << row.file;
    EXPECT_EQ(topology.is_closed(), !row.touches_border) << row.file;
    const Isosurface closed = marching_cubes(image, row.range, {}, Context());
    EXPECT_EQ(describe_violations(examine_topology(closed.surface)), "") << row.file;
  }
}

fs::path cranium() {
  const char* cache = std::getenv("PERIOST_CACHE");
  const char* home = std::getenv("HOME");
  const fs::path base =
      cache != nullptr ? fs::path(cache) : fs::path(home != nullptr ? home : "/") / ".cache/periost/data";
  return base / "invesalius-examples/usr/share/doc/invesalius-examples/examples/Cranium.inv3";
}

TEST(RealImages, SkullIsClosedAndManifold) {
  if (!fs::exists(cranium())) GTEST_SKIP() << "fetch it with scripts/fetch_data.sh";
  const Image image = read_image(cranium());
  const Mask mask = threshold(image, {.lower = 226, .keep = {1}}, {});
  const Isosurface isosurface = marching_cubes(&image, mask, {}, Context());
  const Topology topology = examine_topology(isosurface.surface);
  EXPECT_EQ(describe_violations(topology), "");
  EXPECT_EQ(topology.triangles, 535978u);
  // The filled voxels leave no surface of a cavity: every component encloses bone.
  EXPECT_NEAR(signed_volume(isosurface.surface), 609430, 100);
}

TEST(RealImages, SkullWithItsCavitiesHasOneSurfaceMoreForEach) {
  if (!fs::exists(cranium())) GTEST_SKIP() << "fetch it with scripts/fetch_data.sh";
  const Image image = read_image(cranium());
  const Mask mask = threshold(image, {.lower = 226, .keep = {1}, .fill_holes = {0.0}}, {});
  const Isosurface isosurface = marching_cubes(&image, mask, {}, Context());
  const auto components = triangle_components(isosurface.surface.triangles, isosurface.surface.points.size());
  std::vector<std::size_t> sizes;
  for (const auto component : components) {
    if (component >= sizes.size()) sizes.resize(component + 1);
    ++sizes[component];
  }
  // The largest surface was counted with another program, too.
  EXPECT_EQ(*std::max_element(sizes.begin(), sizes.end()), 535354u);
}

}  // namespace
}  // namespace periost
