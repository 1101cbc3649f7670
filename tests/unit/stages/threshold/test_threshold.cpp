#include "stages/threshold/threshold.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <numeric>

#include "pipeline/base/error.h"
#include "pipeline/base/random.h"
#include "pipeline/geometry/voxel_components.h"

namespace periost {
namespace {

using testing::HasSubstr;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Image empty_image(std::array<std::int32_t, 3> dims) {
  Image image{GridFrame{dims, {0.5, 1, 2}, {3, -4, 5}, {}}, {}};
  image.values.assign(image.frame.voxel_count(), 0.0f);
  return image;
}

void fill_box(Image& image, std::array<std::int32_t, 3> low, std::array<std::int32_t, 3> high, float value) {
  for (std::int32_t k = low[2]; k <= high[2]; ++k) {
    for (std::int32_t j = low[1]; j <= high[1]; ++j) {
      for (std::int32_t i = low[0]; i <= high[0]; ++i) image.values[image.frame.offset(i, j, k)] = value;
    }
  }
}

std::size_t count(const Mask& mask) {
  return std::accumulate(mask.inside.begin(), mask.inside.end(), std::size_t{0});
}

// Components by flooding from voxel to voxel: slow and plain, to check the labelling against.
std::vector<int> flooded_labels(const std::array<std::int32_t, 3>& dims,
                                const std::vector<std::uint8_t>& bytes, bool of_zeros,
                                Connectivity connectivity) {
  const GridFrame frame{dims, {}, {}, {}};
  std::vector<int> labels(bytes.size(), -1);
  int next = 0;
  for (std::size_t start = 0; start < bytes.size(); ++start) {
    if (labels[start] >= 0 || (bytes[start] == 0) != of_zeros) continue;
    std::vector<std::size_t> stack{start};
    labels[start] = next;
    while (!stack.empty()) {
      const auto v = static_cast<std::int32_t>(stack.back());
      stack.pop_back();
      const std::int32_t i = v % dims[0];
      const std::int32_t j = v / dims[0] % dims[1];
      const std::int32_t k = v / dims[0] / dims[1];
      for (std::int32_t n = 0; n < 27; ++n) {
        const std::int32_t a = n % 3 - 1;
        const std::int32_t b = n / 3 % 3 - 1;
        const std::int32_t c = n / 9 - 1;
        const bool is_neighbour =
            connectivity == Connectivity::kCorners || std::abs(a) + std::abs(b) + std::abs(c) == 1;
        if (!is_neighbour || !frame.contains(i + a, j + b, k + c)) continue;
        const std::size_t w = frame.offset(i + a, j + b, k + c);
        if (labels[w] >= 0 || (bytes[w] == 0) != of_zeros) continue;
        labels[w] = next;
        stack.push_back(w);
      }
    }
    ++next;
  }
  return labels;
}

TEST(VoxelComponents, AgreeWithFloodingOnNoise) {
  Context two;
  two.threads = 2;
  for (std::uint64_t seed = 1; seed <= 24; ++seed) {
    const std::array<std::int32_t, 3> dims{static_cast<std::int32_t>(9 + seed), 11, 21};
    Random random(seed, 0);
    std::vector<std::uint8_t> bytes(GridFrame{dims, {}, {}, {}}.voxel_count());
    for (auto& byte : bytes) byte = random.below(10) < 2 + seed % 7 ? 1 : 0;
    const bool of_zeros = seed % 2 == 0;
    const Connectivity connectivity = seed % 4 < 2 ? Connectivity::kFaces : Connectivity::kCorners;
    const std::vector<int> expected = flooded_labels(dims, bytes, of_zeros, connectivity);
    const VoxelComponents found = label_components(dims, bytes, of_zeros, connectivity, two);
    std::vector<int> labels(bytes.size(), -1);
    for (std::size_t r = 0; r + 1 < found.row_first.size(); ++r) {
      for (std::size_t n = found.row_first[r]; n < found.row_first[r + 1]; ++n) {
        for (std::int32_t i = found.runs[n].begin; i < found.runs[n].end; ++i) {
          labels[r * static_cast<std::size_t>(dims[0]) + static_cast<std::size_t>(i)] =
              static_cast<int>(found.runs[n].component);
        }
      }
    }
    EXPECT_EQ(labels, expected) << "seed " << seed;
    std::uint64_t voxels = 0;
    for (const VoxelComponent& component : found.components) voxels += component.voxels;
    EXPECT_EQ(voxels, static_cast<std::uint64_t>(std::count_if(expected.begin(), expected.end(),
                                                               [](int label) { return label >= 0; })));
  }
}

TEST(Threshold, BoundsAreIncluded) {
  Image image = empty_image({4, 1, 1});
  image.values = {1, 2, 3, 4};
  EXPECT_THAT(threshold(image, {.lower = 2, .upper = 3}, {}).inside, testing::ElementsAre(0, 1, 1, 0));
  EXPECT_THAT(threshold(image, {.lower = 2}, {}).inside, testing::ElementsAre(0, 1, 1, 1));
  EXPECT_THAT(threshold(image, {.upper = 3}, {}).inside, testing::ElementsAre(1, 1, 1, 0));
  const Mask mask = threshold(image, {.upper = 3}, {});
  EXPECT_EQ(mask.range->upper, 3);
  EXPECT_EQ(mask.range->lower, -kInfinity);
}

TEST(Threshold, KeepsTheLargestAndFillsItsCavity) {
  Image image = empty_image({20, 20, 20});
  fill_box(image, {2, 2, 2}, {10, 10, 10}, 100);
  fill_box(image, {4, 4, 4}, {8, 8, 8}, 0);
  fill_box(image, {6, 6, 6}, {6, 6, 6}, 100);  // a fragment inside the cavity
  fill_box(image, {13, 13, 13}, {15, 15, 15}, 100);
  EXPECT_EQ(count(threshold(image, {.lower = 50}, {})), 729u - 125 + 1 + 27);
  EXPECT_EQ(count(threshold(image, {.lower = 50, .keep = {1}}, {})), 729u);
  EXPECT_EQ(count(threshold(image, {.lower = 50, .keep = {1}, .fill_holes = {0.0}}, {})), 729u - 125);
  EXPECT_EQ(count(threshold(image, {.lower = 50, .keep = {2}}, {})), 729u - 125 + 27);
  EXPECT_EQ(count(threshold(image, {.lower = 50, .min_volume = 27}, {})), 729u - 125 + 27);
  EXPECT_EQ(count(threshold(image, {.lower = 50, .min_volume = 27.1}, {})), 729u - 125);
  EXPECT_EQ(count(threshold(image, {.lower = 50, .fill_holes = {123.9}}, {})), 729u - 125 + 1 + 27);
  EXPECT_EQ(count(threshold(image, {.lower = 50, .fill_holes = {kInfinity}}, {})), 729u + 27);
}

TEST(Threshold, CavityThatReachesTheBorderStays) {
  Image image = empty_image({9, 9, 9});
  fill_box(image, {1, 1, 1}, {7, 7, 7}, 1);
  fill_box(image, {3, 3, 0}, {4, 4, 5}, 0);
  EXPECT_EQ(count(threshold(image, {.lower = 1, .keep = {1}}, {})), 343u - 4 * 5);
}

TEST(Threshold, EqualComponentsAreKeptInMemoryOrder) {
  Image image = empty_image({9, 3, 3});
  fill_box(image, {6, 0, 0}, {7, 0, 0}, 1);
  fill_box(image, {0, 2, 0}, {1, 2, 0}, 1);
  const Mask mask = threshold(image, {.lower = 1, .keep = {1}}, {});
  EXPECT_EQ(mask.inside[image.frame.offset(6, 0, 0)], 1);
  EXPECT_EQ(mask.inside[image.frame.offset(0, 2, 0)], 0);
}

TEST(Threshold, NothingInsideNamesTheImagesValues) {
  Image image = empty_image({4, 4, 4});
  fill_box(image, {0, 0, 0}, {1, 1, 1}, -7.5f);
  try {
    threshold(image, {.lower = 226}, {});
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kInput);
    EXPECT_EQ(error.code(), "threshold.nothing_inside");
    EXPECT_THAT(error.what(), HasSubstr("from -7.5 to 0"));
  }
  EXPECT_THROW(threshold(image, {.lower = -1, .min_volume = 1e6}, {}), Error);
}

TEST(Threshold, WarnsWhenEverythingIsInside) {
  std::string code;
  Context context;
  context.sink = [&](const Event& event) {
    if (event.level == Event::Level::kWarning) code = event.code;
  };
  threshold(empty_image({4, 4, 4}), {.lower = -1}, context);
  EXPECT_EQ(code, "threshold.everything_inside");
}

TEST(Threshold, NotANumberIsOutside) {
  Image image = empty_image({3, 1, 1});
  image.values = {1, std::numeric_limits<float>::quiet_NaN(), 1};
  EXPECT_THAT(threshold(image, {.lower = 0}, {}).inside, testing::ElementsAre(1, 0, 1));
  EXPECT_THAT(threshold(image, {.upper = 2}, {}).inside, testing::ElementsAre(1, 0, 1));
}

TEST(Threshold, OptionTextsReadBack) {
  for (const char* text : {"all", "largest", "17"}) EXPECT_EQ(KeepComponents::parse(text)->text(), text);
  for (const char* text : {"auto", "none", "all", "12.5 mm3"})
    EXPECT_EQ(FillHoles::parse(text)->text(), text);
  for (const char* text : {"", "0", "-1", "1.5", "007", "larges"})
    EXPECT_FALSE(KeepComponents::parse(text)) << text;
  for (const char* text : {"", "-1", "mm3", "some", "1 cm3"}) EXPECT_FALSE(FillHoles::parse(text)) << text;
}

}  // namespace
}  // namespace periost
