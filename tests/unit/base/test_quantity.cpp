#include <gtest/gtest.h>

#include "pipeline/base/diagnostic.h"
#include "pipeline/base/quantity.h"

namespace periost {
namespace {

TEST(Quantity, ReadsLengthsInEveryUnit) {
  EXPECT_EQ(parse_length("0.3 voxel"), Length::voxel(0.3));
  EXPECT_EQ(parse_length("0.3voxel"), Length::voxel(0.3));
  EXPECT_EQ(parse_length("0.45 mm"), Length::mm(0.45));
  EXPECT_EQ(parse_length("2"), Length::mm(2));
  EXPECT_EQ(parse_length("1 cm"), Length::mm(10));
  EXPECT_EQ(parse_length("1e-1mm"), Length::mm(0.1));
}

TEST(Quantity, RefusesWhatIsNotALength) {
  for (const char* text :
       {"", "mm", "3 apples", "0.3  voxel", "nan", "inf", "010", "1,5 mm", "0x10", "3 deg", "--1"}) {
    EXPECT_FALSE(parse_length(text)) << text;
  }
}

TEST(Quantity, ByteSizesNeedAUnit) {
  EXPECT_EQ(parse_byte_size("4GiB"), ByteSize{4ull << 30});
  EXPECT_EQ(parse_byte_size("500MB"), ByteSize{500'000'000});
  EXPECT_FALSE(parse_byte_size("500"));
  EXPECT_FALSE(parse_byte_size("-1GB"));
}

TEST(Quantity, TextReadsBackToTheSameValue) {
  for (const double value : {0.1, 1.0 / 3.0, 1e-300, -226.0, 123456789.125}) {
    EXPECT_EQ(parse_number(to_text(value)), value);
    EXPECT_EQ(parse_length(to_text(Length::voxel(value))), Length::voxel(value));
  }
  EXPECT_EQ(parse_byte_size(to_text(ByteSize{3ull << 30})), ByteSize{3ull << 30});
  EXPECT_EQ(parse_byte_size(to_text(ByteSize{12345})), ByteSize{12345});
}

TEST(Diagnostic, SuggestsTheNearestName) {
  EXPECT_EQ(nearest_name("distnce", {"distance", "stiffness", "topology"}), "distance");
  EXPECT_EQ(nearest_name("rigdiity", {"distance", "rigidity"}), "rigidity");
  EXPECT_EQ(nearest_name("xyz", {"distance", "rigidity"}), "");
}

TEST(Diagnostic, FormatsOneLineWithItsPlace) {
  const Diagnostic diagnostic{
      Severity::kError,        "config.unknown_key",      "decimate", "distnce", {"femur.yaml", 12, 5},
      "unknown key 'distnce'", "did you mean 'distance'?"};
  EXPECT_EQ(format(diagnostic),
            "femur.yaml:12:5: error: stage 'decimate': unknown key 'distnce'; did you mean 'distance'? "
            "[config.unknown_key]");
}

}  // namespace
}  // namespace periost
