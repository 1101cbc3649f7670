#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/io/image_write.h"
#include "stages/read_mask/read_mask.h"
#include "tests/unit/io/image_files.h"

namespace periost {
namespace {

using namespace test;

// Labels 0, 3, 7 in slabs along k.
Image label_map() {
  Image image;
  image.frame = {{4, 5, 6}, {1, 2, 3}, {-10, 20, 30}, {{Vec3{0, 1, 0}, Vec3{1, 0, 0}, Vec3{0, 0, 1}}}};
  for (std::size_t n = 0; n < image.frame.voxel_count(); ++n) {
    image.values.push_back(n < 40 ? 0.0F : n < 80 ? 3.0F : 7.0F);
  }
  return image;
}

class ReadMask : public testing::Test {
 protected:
  ReadMask() { write_image(path_, label_map()); }
  std::size_t inside(const std::vector<std::int64_t>& labels) {
    const Mask mask = read_mask({path_, labels, false}, nullptr, {});
    return static_cast<std::size_t>(std::count(mask.inside.begin(), mask.inside.end(), 1));
  }
  std::string refused(const ReadMaskOptions& options, const GridFrame& grid) {
    try {
      read_mask(options, &grid, {});
    } catch (const Error& error) {
      said_ = std::string(error.what()) + " " + error.hint();
      return error.code();
    }
    return {};
  }
  Folder folder_;
  std::filesystem::path path_ = folder_.path() / "labels.mha";
  std::string said_;
};

TEST_F(ReadMask, LabelsChooseWhatIsInside) {
  EXPECT_EQ(inside({}), 80u);
  EXPECT_EQ(inside({3}), 40u);
  EXPECT_EQ(inside({3, 7}), 80u);
  EXPECT_EQ(inside({0}), 40u);
}

TEST_F(ReadMask, AnAbsentLabelIsRefusedWithThoseThere) {
  EXPECT_EQ(refused({path_, {5}, false}, label_map().frame), "mask.empty");
  EXPECT_THAT(said_, testing::HasSubstr("3, 7"));
}

TEST_F(ReadMask, AnotherGridIsRefusedWithItsDistance) {
  GridFrame grid = label_map().frame;
  grid.origin.x += 1.25;
  EXPECT_EQ(refused({path_, {}, false}, grid), "mask.frame");
  EXPECT_THAT(said_, testing::HasSubstr("1.25 mm"));
  grid.dims[0] = 9;
  EXPECT_EQ(refused({path_, {}, false}, grid), "mask.frame");
  EXPECT_THAT(said_, testing::HasSubstr("9 x 5 x 6"));
  grid = label_map().frame;
  grid.origin.x += 1e-5;
  EXPECT_EQ(read_mask({path_, {}, false}, &grid, {}).frame, grid);
}

TEST_F(ReadMask, ResamplingIsTheNearestVoxelForAnyNumberOfThreads) {
  const Mask mask = mask_of_labels(label_map().frame, label_map().values, {3});
  EXPECT_EQ(resample_nearest(mask, mask.frame, {}).inside, mask.inside);

  GridFrame fine = mask.frame;  // three voxels for each, around the same centres
  fine.dims = {12, 15, 18};
  fine.spacing = fine.spacing / 3;
  fine.origin = mask.frame.to_lps({-1.0 / 3, -1.0 / 3, -1.0 / 3});
  const Mask three = resample_nearest(mask, fine, {});
  for (std::int32_t k = 0; k < 18; ++k) {
    for (std::int32_t j = 0; j < 15; ++j) {
      for (std::int32_t i = 0; i < 12; ++i) {
        ASSERT_EQ(three.inside[fine.offset(i, j, k)], mask.inside[mask.frame.offset(i / 3, j / 3, k / 3)]);
      }
    }
  }
  Context two;
  two.threads = 2;
  EXPECT_EQ(resample_nearest(mask, fine, two).inside, three.inside);
}

TEST_F(ReadMask, AGridElsewhereIsRefusedEvenWhenResampling) {
  GridFrame grid = label_map().frame;
  grid.origin.x += 1e12;
  EXPECT_EQ(refused({path_, {}, true}, grid), "mask.empty");
}

}  // namespace
}  // namespace periost
