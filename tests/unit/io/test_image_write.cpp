// What is written reads back: voxels to the bit, frames to the precision of the format.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "pipeline/io/image_write.h"
#include "pipeline/io/nifti_write.h"
#include "tests/unit/io/image_files.h"

namespace periost {
namespace {

using namespace test;

// A rotation by `degrees` about a skew axis.
Mat3 rotation(double degrees) {
  const Vec3 u = normalized({1, -2, 0.5});
  const double c = std::cos(degrees * M_PI / 180), s = std::sin(degrees * M_PI / 180);
  Mat3 m;
  for (std::size_t a = 0; a < 3; ++a) {
    Vec3 e;
    e[a] = 1;
    m.column[a] = e * c + cross(u, e) * s + u * (dot(u, e) * (1 - c));
  }
  return m;
}

Image ramp(const Mat3& direction) {
  Image image;
  image.frame = {{5, 4, 3}, {0.7, 1.1, 2.5}, {-120.25, 33.5, 1007.125}, direction};
  for (std::size_t n = 0; n < image.frame.voxel_count(); ++n)
    image.values.push_back(-1024.0F + 1.5F * static_cast<float>(n));
  return image;
}

std::vector<Mat3> directions() {
  std::vector<Mat3> all{Mat3{}, rotation(17), rotation(180), rotation(123.4)};
  for (std::size_t n = 0; n < 4; ++n) {
    Mat3 mirrored = all[n];
    mirrored.column[n % 3] = -mirrored.column[n % 3];
    all.push_back(mirrored);
  }
  return all;
}

class ImageWrite : public testing::TestWithParam<const char*> {};

TEST_P(ImageWrite, ReadsBack) {
  const Folder folder;
  const std::string ending = GetParam();
  // NIfTI-1 has single precision; the others keep what was written, up to the product and quotient with the
  // spacing.
  const double tolerance = ending.starts_with(".nii") ? 1e-4 : 1e-12;
  for (const Mat3& direction : directions()) {
    const Image image = ramp(direction);
    const auto path = folder.path() / ("image" + ending);
    write_image(path, image);
    const Image back = read_image(path);
    EXPECT_EQ(back.values, image.values);
    EXPECT_EQ(back.frame.dims, image.frame.dims);
    EXPECT_EQ(back.frame.is_left_handed(), image.frame.is_left_handed());
    EXPECT_TRUE(same_grid(back.frame, image.frame, tolerance)) << describe(back.frame) << "\n"
                                                               << describe(image.frame);
  }
}

TEST_P(ImageWrite, MasksReadBack) {
  const Folder folder;
  Mask mask;
  mask.frame = ramp(rotation(17)).frame;
  for (std::size_t n = 0; n < mask.frame.voxel_count(); ++n) mask.inside.push_back(n % 3 == 0 ? 1 : 0);
  const auto path = folder.path() / (std::string("mask") + GetParam());
  write_mask(path, mask);
  const Image back = read_image(path);
  EXPECT_EQ(read_image_header(path).type, VoxelType::kUint8);
  EXPECT_THAT(std::vector<std::uint8_t>(back.values.begin(), back.values.end()),
              testing::ElementsAreArray(mask.inside));
}

TEST_P(ImageWrite, SameImageGivesTheSameBytes) {
  const Folder folder;
  const Image image = ramp(rotation(17));
  write_image(folder.path() / (std::string("a") + GetParam()), image);
  write_image(folder.path() / (std::string("b") + GetParam()), image);
  EXPECT_EQ(read_bytes(folder.path() / (std::string("a") + GetParam())),
            read_bytes(folder.path() / (std::string("b") + GetParam())));
}

INSTANTIATE_TEST_SUITE_P(Formats, ImageWrite, testing::Values(".nii", ".nii.gz", ".mha", ".nrrd", ".vti"));

TEST(ImageWriteBytes, NiftiIsWhatTheFormatSays) {
  const Folder folder;
  Image image;
  image.frame = {{2, 1, 1}, {1, 2, 3}, {-10, 20, 30}, {}};
  image.values = {1, -2};
  write_image(folder.path() / "a.nii", image);
  std::string expected(352, '\0');
  put(expected, 0, std::int32_t{348});
  expected[38] = 'r';
  const std::array<std::int16_t, 8> dim{3, 2, 1, 1, 1, 1, 1, 1};
  for (std::size_t n = 0; n < 8; ++n) put(expected, 40 + 2 * n, dim[n]);
  put(expected, 70, std::int16_t{16});
  put(expected, 72, std::int16_t{32});
  const std::array<float, 4> pixdim{1, 1, 2, 3};
  for (std::size_t n = 0; n < 4; ++n) put(expected, 76 + 4 * n, pixdim[n]);
  put(expected, 108, 352.0F);
  put(expected, 112, 1.0F);
  expected[123] = 2;
  put(expected, 252, std::int16_t{1});
  put(expected, 254, std::int16_t{1});
  put(expected, 264, 1.0F);  // LPS axes in RAS: a half turn about z
  put(expected, 268, 10.0F), put(expected, 272, -20.0F), put(expected, 276, 30.0F);
  const std::array<float, 12> rows{-1, 0, 0, 10, 0, -2, 0, -20, 0, 0, 3, 30};
  for (std::size_t n = 0; n < 12; ++n) put(expected, 280 + 4 * n, rows[n]);
  put_text(expected, 344, "n+1");
  EXPECT_EQ(read_bytes(folder.path() / "a.nii"), expected + bytes_of_values<float>({1, -2}));
}

TEST(ImageWriteBytes, GzipHasNoTimeAndNoSystem) {
  const Folder folder;
  write_image(folder.path() / "a.nii.gz", ramp({}));
  const std::string bytes = read_bytes(folder.path() / "a.nii.gz");
  EXPECT_EQ(bytes.substr(0, 8), std::string("\x1f\x8b\x08\0\0\0\0\0", 8));
  EXPECT_EQ(bytes[9], '\xff');
}

TEST(ImageWriteBytes, TextHeadersAreWhatTheFormatsSay) {
  const Folder folder;
  Image image;
  image.frame = {{2, 1, 1}, {0.5, 2, 3}, {-10, 20, 30.25}, {{Vec3{0, 1, 0}, Vec3{-1, 0, 0}, Vec3{0, 0, 1}}}};
  image.values = {1, -2};
  const std::string voxels = bytes_of_values<float>({1, -2});
  write_image(folder.path() / "a.mha", image);
  EXPECT_EQ(read_bytes(folder.path() / "a.mha"),
            "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
            "CompressedData = False\nTransformMatrix = 0 1 0 -1 0 0 0 0 1\nOffset = -10 20 30.25\n"
            "CenterOfRotation = 0 0 0\nElementSpacing = 0.5 2 3\nDimSize = 2 1 1\nElementType = MET_FLOAT\n"
            "ElementDataFile = LOCAL\n" +
                voxels);
  write_image(folder.path() / "a.nrrd", image);
  EXPECT_THAT(read_bytes(folder.path() / "a.nrrd"),
              testing::StartsWith(
                  "NRRD0004\ntype: float\ndimension: 3\nspace: left-posterior-superior\nsizes: 2 1 1\n"
                  "space directions: (0,0.5,0) (-2,0,0) (0,0,3)\nkinds: domain domain domain\n"
                  "endian: little\nencoding: gzip\nspace origin: (-10,20,30.25)\n\n\x1f\x8b"));
}

// The reader of NIfTI files can take either form; both must say the same.
TEST(ImageWriteBytes, QformAndSformAgree) {
  const Folder folder;
  for (const Mat3& direction : directions()) {
    write_image(folder.path() / "a.nii", ramp(direction));
    std::string bytes = read_bytes(folder.path() / "a.nii");
    const GridFrame sform = read_image_frame(folder.path() / "a.nii");
    put(bytes, 254, std::int16_t{0});
    const GridFrame qform = read_image_frame(folder.write("q.nii", bytes));
    EXPECT_TRUE(same_grid(sform, qform, 1e-4)) << describe(sform) << "\n" << describe(qform);
  }
}

TEST(ImageWriteBytes, RefusesOtherEndingsAndSizesBeyondTheFormat) {
  const Folder folder;
  Image image = ramp({});
  EXPECT_FALSE(is_writable_image_format("a.png"));
  EXPECT_THROW(write_image(folder.path() / "a.png", image), Error);
  image.frame.dims = {40000, 1, 1};
  image.values.assign(40000, 0);
  EXPECT_THROW(write_image(folder.path() / "a.nii", image), Error);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  EXPECT_NO_THROW(write_image(folder.path() / "a.mha", image));
}

}  // namespace
}  // namespace periost
