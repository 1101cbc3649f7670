// Readers against real files: those of PERIOST_TEST_DATA and the CT that Debian packages.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "pipeline/base/error.h"
#include "pipeline/io/image_read.h"

namespace periost {
namespace {

namespace fs = std::filesystem;

fs::path test_data() {
  const char* folder = std::getenv("PERIOST_TEST_DATA");
  return folder == nullptr ? fs::path() : fs::path(folder);
}

#define NEED_TEST_DATA() \
  if (test_data().empty() || !fs::exists(test_data())) GTEST_SKIP() << "PERIOST_TEST_DATA names no folder"

fs::path cranium() {
  const char* cache = std::getenv("PERIOST_CACHE");
  const char* home = std::getenv("HOME");
  const fs::path base =
      cache != nullptr ? fs::path(cache) : fs::path(home != nullptr ? home : "/") / ".cache/periost/data";
  return base / "invesalius-examples/usr/share/doc/invesalius-examples/examples/Cranium.inv3";
}

TEST(RealImages, SkullOfInVesaliusHasItsFrameAndRange) {
  if (!fs::exists(cranium())) GTEST_SKIP() << "fetch it with scripts/fetch_data.sh";
  std::string log;
  Context context;
  context.sink = [&](const Event& event) {
    if (event.level == Event::Level::kInfo) log += event.text + "\n";
  };
  const Image image = read_image(cranium(), {}, context);
  EXPECT_EQ(image.frame.dims, (std::array<std::int32_t, 3>{256, 256, 108}));
  EXPECT_DOUBLE_EQ(image.frame.spacing.x, 0.9570312);
  EXPECT_DOUBLE_EQ(image.frame.spacing.z, 1.5);
  EXPECT_EQ(image.frame.direction.column[1], (Vec3{0, -1, 0}));
  const auto [low, high] = std::minmax_element(image.values.begin(), image.values.end());
  EXPECT_EQ(*low, -1024);
  EXPECT_EQ(*high, 2986);
  EXPECT_NE(log.find("assumed"), std::string::npos);
  EXPECT_EQ(log.find("ProMED"), std::string::npos);
  EXPECT_EQ(read_image_frame(cranium()), image.frame);
}

TEST(RealImages, EveryNiftiOfTheTestDataIsRead) {
  NEED_TEST_DATA();
  int count = 0;
  for (const auto& entry : fs::directory_iterator(test_data())) {
    if (!entry.path().filename().string().ends_with(".nii.gz")) continue;
    const Image image = read_image(entry.path());
    EXPECT_EQ(image.values.size(), image.frame.voxel_count());
    const Vec3 index{3, 5, 7};
    EXPECT_LT(distance(image.frame.to_index(image.frame.to_lps(index)), index), 1e-9) << entry.path();
    ++count;
  }
  EXPECT_GE(count, 6);
}

// First and last voxel centre in LPS mm and the sum of all values, as nibabel 5.0 computes them.
TEST(RealImages, FramesAndValuesAgreeWithAnotherReader) {
  NEED_TEST_DATA();
  struct Row {
    const char* name;
    Vec3 first;
    Vec3 last;
    double sum;
  };
  for (const Row& row : {Row{"femur_leg_ct", {-72.8574, -72.8574, -273}, {71.6426, 71.6426, 270}, -6.99095e8},
                         Row{"totalseg_torso_ct_3mm",
                             {177.9563, -11.3190, 94.3018},
                             {-185.0437, -311.3190, 427.3018},
                             -4.96851e8},
                         Row{"verse004_vertebrae_mask",
                             {77.6940, -218.0015, -808.5780},
                             {-47.0015, -89.7194, -1157.2440},
                             4.18557e6}}) {
    const Image image = read_image(test_data() / (std::string(row.name) + ".nii.gz"));
    const auto& dims = image.frame.dims;
    EXPECT_LT(distance(image.frame.to_lps({0, 0, 0}), row.first), 1e-4) << row.name;
    EXPECT_LT(distance(image.frame.to_lps({dims[0] - 1.0, dims[1] - 1.0, dims[2] - 1.0}), row.last), 1e-4)
        << row.name;
    double sum = 0;
    for (const float value : image.values) sum += static_cast<double>(value);
    EXPECT_NEAR(sum / row.sum, 1, 1e-5) << row.name;
  }
}

TEST(RealImages, BrokenFilesAreRefusedWithASentence) {
  NEED_TEST_DATA();
  int count = 0;
  for (const char* folder : {"hard_small", "pydicom_test_files"}) {
    for (const auto& entry : fs::recursive_directory_iterator(test_data() / folder)) {
      if (!entry.is_regular_file()) continue;
      ++count;
      try {
        read_image(entry.path());
        ADD_FAILURE() << entry.path() << " was read";
      } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::kInput) << entry.path();
        EXPECT_TRUE(error.code().starts_with("image.")) << error.code();
        RecordProperty(entry.path().filename().string(), error.what());
      }
    }
  }
  EXPECT_GE(count, 11);
}

}  // namespace
}  // namespace periost
