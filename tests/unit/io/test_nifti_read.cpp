// NIfTI files put together byte by byte from the format's description.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/unit/io/image_files.h"

namespace periost {
namespace {

using namespace test;

const std::string kVoxels = bytes_of_values(counting<std::int16_t>());

void put_sform(std::string& h, const std::array<float, 12>& rows, bool big = false) {
  put(h, 254, std::int16_t{1}, big);
  for (std::size_t n = 0; n < 12; ++n) put(h, 280 + 4 * n, rows[n], big);
}

void expect_near(Vec3 a, Vec3 b) {
  EXPECT_NEAR(a.x, b.x, 1e-6);
  EXPECT_NEAR(a.y, b.y, 1e-6);
  EXPECT_NEAR(a.z, b.z, 1e-6);
}

TEST(NiftiRead, SformIsTurnedFromRasToLps) {
  const Folder folder;
  for (const bool big : {false, true}) {
    std::string h = nifti1(big);
    // i grows to anterior by 2 mm, j to the left by 1, k to superior by 3.
    put_sform(h, {0, -1, 0, 10, 2, 0, 0, 20, 0, 0, 3, 30}, big);
    const Image image = read_image(folder.write("a.nii", h + bytes_of_values(counting<std::int16_t>(), big)));
    EXPECT_EQ(image.frame.dims, (std::array<std::int32_t, 3>{2, 3, 4}));
    EXPECT_EQ(image.frame.spacing, (Vec3{2, 1, 3}));
    EXPECT_EQ(image.frame.to_lps({0, 0, 0}), (Vec3{-10, -20, 30}));
    EXPECT_EQ(image.frame.to_lps({1, 0, 0}), (Vec3{-10, -22, 30}));
    EXPECT_EQ(image.frame.to_lps({0, 1, 0}), (Vec3{-9, -20, 30}));
    EXPECT_EQ(image.frame.to_lps({0, 0, 1}), (Vec3{-10, -20, 33}));
    EXPECT_FALSE(image.frame.is_left_handed());
    EXPECT_EQ(image.values, counting<float>());
  }
}

TEST(NiftiRead, SformOfNegativeDeterminantStaysLeftHanded) {
  const Folder folder;
  std::string h = nifti1();
  put_sform(h, {-1, 0, 0, 5, 0, 2, 0, 6, 0, 0, 3, 7});
  const GridFrame frame = read_image_frame(folder.write("a.nii", h + kVoxels));
  EXPECT_TRUE(frame.is_left_handed());
  EXPECT_EQ(frame.to_lps({1, 1, 1}), (Vec3{-4, -8, 10}));
}

TEST(NiftiRead, QformGivesTheRotationOfItsQuaternion) {
  const Folder folder;
  for (const float qfac : {1.0F, -1.0F}) {
    std::string h = nifti1();
    put(h, 252, std::int16_t{1});
    put(h, 76, qfac);
    // 30 degrees about the patient's z: i turns from right towards anterior.
    put(h, 264, static_cast<float>(std::sin(15 * M_PI / 180)));
    put(h, 268, 7.0F);
    put(h, 272, 8.0F);
    put(h, 276, 9.0F);
    const GridFrame frame = read_image_frame(folder.write("a.nii", h + kVoxels));
    const double c = std::cos(M_PI / 6), s = std::sin(M_PI / 6);
    expect_near(frame.origin, {-7, -8, 9});
    expect_near(frame.to_lps({1, 0, 0}) - frame.origin, {-c, -s, 0});
    expect_near(frame.to_lps({0, 1, 0}) - frame.origin, {2 * s, -2 * c, 0});
    expect_near(frame.to_lps({0, 0, 1}) - frame.origin, {0, 0, static_cast<double>(qfac) * 3});
    EXPECT_EQ(frame.is_left_handed(), qfac < 0);
  }
}

TEST(NiftiRead, QformOfAHalfTurnNeedsNoFourthNumber) {
  const Folder folder;
  std::string h = nifti1();
  put(h, 252, std::int16_t{2});
  put(h, 264, 1.0F);  // d = 1: 180 degrees about z
  const GridFrame frame = read_image_frame(folder.write("a.nii", h + kVoxels));
  expect_near(frame.to_lps({1, 1, 1}), {1, 2, 3});
}

TEST(NiftiRead, SformWinsOverQform) {
  const Folder folder;
  std::string h = nifti1();
  put(h, 252, std::int16_t{1});
  put_sform(h, {1, 0, 0, 1, 0, 2, 0, 2, 0, 0, 3, 3});
  EXPECT_EQ(read_image_frame(folder.write("a.nii", h + kVoxels)).origin, (Vec3{-1, -2, 3}));
}

TEST(NiftiRead, WithoutOrientationSaysWhatItAssumes) {
  const Folder folder;
  std::vector<std::string> log;
  Context context;
  context.sink = [&](const Event& event) { log.push_back(event.code); };
  const Image image = read_image(folder.write("a.nii", nifti1() + kVoxels), {}, context);
  expect_near(image.frame.to_lps({1, 1, 1}), {-1, -2, 3});
  EXPECT_THAT(log, testing::Contains("image.assumed"));
}

TEST(NiftiRead, ScalingIsAppliedUnlessItsSlopeIsZero) {
  const Folder folder;
  std::string h = nifti1();
  put(h, 112, 0.5F);
  put(h, 116, -1024.0F);
  EXPECT_EQ(read_image(folder.write("a.nii", h + kVoxels)).values[3], -1022.5F);
  put(h, 112, 0.0F);
  EXPECT_EQ(read_image(folder.write("a.nii", h + kVoxels)).values[3], 3.0F);
  put(h, 112, std::numeric_limits<float>::quiet_NaN());
  EXPECT_EQ(read_image(folder.write("a.nii", h + kVoxels)).values[3], 3.0F);
  put(h, 112, 1.0F);
  put(h, 116, std::numeric_limits<float>::infinity());
  EXPECT_EQ(refusal(folder.write("a.nii", h + kVoxels)), "image.header");
}

TEST(NiftiRead, UnitsOfLengthBecomeMillimetres) {
  const Folder folder;
  std::string h = nifti1();
  put_sform(h, {1, 0, 0, 4, 0, 2, 0, 0, 0, 0, 3, 0});
  const std::array<double, 4> mm{1, 1000, 1, 0.001};
  for (std::size_t unit = 0; unit < 4; ++unit) {
    h[123] = static_cast<char>(unit | 8);  // seconds in the other bits
    const GridFrame frame = read_image_frame(folder.write("a.nii", h + kVoxels));
    EXPECT_NEAR(frame.spacing.z, 3 * mm[unit], 1e-12);
    EXPECT_NEAR(frame.origin.x, -4 * mm[unit], 1e-12);
  }
  h[123] = 5;
  EXPECT_EQ(refusal(folder.write("a.nii", h + kVoxels)), "image.header");
}

TEST(NiftiRead, EveryNumberTypeIsRead) {
  const Folder folder;
  const auto check = [&](int code, const std::string& voxels) {
    std::string h = nifti1();
    put(h, 70, static_cast<std::int16_t>(code));
    EXPECT_EQ(read_image(folder.write("a.nii", h + voxels)).values, counting<float>()) << code;
  };
  check(2, bytes_of_values(counting<std::uint8_t>()));
  check(4, bytes_of_values(counting<std::int16_t>()));
  check(8, bytes_of_values(counting<std::int32_t>()));
  check(16, bytes_of_values(counting<float>()));
  check(64, bytes_of_values(counting<double>()));
  check(256, bytes_of_values(counting<std::int8_t>()));
  check(512, bytes_of_values(counting<std::uint16_t>()));
  check(768, bytes_of_values(counting<std::uint32_t>()));
  check(1024, bytes_of_values(counting<std::int64_t>()));
  check(1280, bytes_of_values(counting<std::uint64_t>()));
  for (const int code : {1, 32, 128, 2304, 77}) {
    std::string h = nifti1();
    put(h, 70, static_cast<std::int16_t>(code));
    EXPECT_EQ(refusal(folder.write("a.nii", h + std::string(400, '\0'))), "image.type") << code;
  }
}

TEST(NiftiRead, VersionTwoHasItsOwnOffsets) {
  const Folder folder;
  for (const bool big : {false, true}) {
    std::string h(544, '\0');
    put(h, 0, std::int32_t{540}, big);
    put_text(h, 4, {"n+2\0\r\n\032\n", 8});
    put(h, 12, std::int16_t{4}, big);
    const std::array<std::int64_t, 8> dim{3, 2, 3, 4, 1, 1, 1, 1};
    for (std::size_t n = 0; n < 8; ++n) put(h, 16 + 8 * n, dim[n], big);
    const std::array<double, 4> pixdim{1, 1, 2, 3};
    for (std::size_t n = 0; n < 4; ++n) put(h, 104 + 8 * n, pixdim[n], big);
    put(h, 168, std::int64_t{544}, big);
    put(h, 176, 2.0, big);
    put(h, 184, 0.1, big);
    put(h, 348, std::int32_t{1}, big);
    const std::array<double, 12> rows{1, 0, 0, 0.1, 0, 2, 0, 0.2, 0, 0, 3, 0.3};
    for (std::size_t n = 0; n < 12; ++n) put(h, 400 + 8 * n, rows[n], big);
    put(h, 500, std::int32_t{2}, big);
    const Image image = read_image(folder.write("a.nii", h + bytes_of_values(counting<std::int16_t>(), big)));
    EXPECT_EQ(image.frame.origin, (Vec3{-0.1, -0.2, 0.3}));
    EXPECT_EQ(image.values[5], 10.1F);
  }
}

TEST(NiftiRead, CompressedAndPairedFilesAreTheSame) {
  const Folder folder;
  const std::string whole = nifti1() + kVoxels;
  const Image plain = read_image(folder.write("a.nii", whole));
  EXPECT_EQ(read_image(folder.write("a.nii.gz", deflated(whole))).values, plain.values);
  // Two gzip members make one stream.
  EXPECT_EQ(read_image(folder.write("b.nii.gz", deflated(whole.substr(0, 100)) + deflated(whole.substr(100))))
                .values,
            plain.values);
  // A compressed file without .gz is known by its first bytes.
  EXPECT_EQ(read_image(folder.write("c.nii", deflated(whole))).values, plain.values);

  std::string h = nifti1();
  put_text(h, 344, "ni1");
  put(h, 108, 0.0F);
  const auto header = folder.write("p.hdr", h.substr(0, 348));
  EXPECT_EQ(refusal(header), "image.missing");
  folder.write("p.img", kVoxels);
  EXPECT_EQ(read_image(header).values, plain.values);
  EXPECT_EQ(read_image_header(header).files.size(), 2u);
}

TEST(NiftiRead, OneVolumeAmongMoreAxesIsAccepted) {
  const Folder folder;
  std::string h = nifti1();
  put(h, 40, std::int16_t{4});
  EXPECT_EQ(refusal(folder.write("a.nii", h + kVoxels)), "");
  put(h, 48, std::int16_t{2});
  EXPECT_EQ(refusal(folder.write("a.nii", h + kVoxels + kVoxels)), "image.dims");
}

TEST(NiftiRead, RefusesWhatCannotBe) {
  const Folder folder;
  const auto refused = [&](auto change) {
    std::string h = nifti1();
    change(h);
    return refusal(folder.write("a.nii", h + kVoxels));
  };
  EXPECT_EQ(refused([](std::string& h) { put(h, 0, std::int32_t{347}); }), "image.header");
  EXPECT_EQ(refused([](std::string& h) { h[344] = 'x'; }), "image.header");
  EXPECT_EQ(refused([](std::string& h) { put(h, 40, std::int16_t{2}); }), "image.dims");
  EXPECT_EQ(refused([](std::string& h) { put(h, 42, std::int16_t{0}); }), "image.dims");
  EXPECT_EQ(refused([](std::string& h) { put(h, 42, std::int16_t{-5}); }), "image.dims");
  EXPECT_EQ(refused([](std::string& h) { put(h, 46, std::int16_t{5}); }), "image.truncated");
  EXPECT_EQ(refused([](std::string& h) { put(h, 80, 0.0F); }), "image.frame");
  EXPECT_EQ(refused([](std::string& h) { put(h, 84, std::numeric_limits<float>::quiet_NaN()); }),
            "image.frame");
  EXPECT_EQ(refused([](std::string& h) { put(h, 108, 1e9F); }), "image.truncated");
  EXPECT_EQ(refused([](std::string& h) { put(h, 108, std::numeric_limits<float>::quiet_NaN()); }),
            "image.header");
  EXPECT_EQ(refused([](std::string& h) { put(h, 108, 5.0F); }), "image.header");
  EXPECT_EQ(refused([](std::string& h) {
              put_sform(h, {1, 0.1F, 0, 0, 0, 2, 0, 0, 0, 0, 3, 0});
            }),
            "image.frame");
  EXPECT_EQ(refused([](std::string& h) {
              put_sform(h, {0, 0, 0, 0, 0, 2, 0, 0, 0, 0, 3, 0});
            }),
            "image.frame");
}

TEST(NiftiRead, RoundedDirectionsBecomeOrthonormal) {
  const Folder folder;
  std::string h = nifti1();
  const auto c = 0.96593F, s = 0.25882F;  // five digits, as text formats write them
  put_sform(h, {c, -s, 0, 0, s, c, 0, 0, 0, 1e-5F, 3, 0});
  const GridFrame frame = read_image_frame(folder.write("a.nii", h + kVoxels));
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t b = 0; b < 3; ++b) {
      EXPECT_NEAR(dot(frame.direction.column[a], frame.direction.column[b]), a == b ? 1 : 0, 1e-15);
    }
  }
}

TEST(NiftiRead, VoxelsThatAreNotFiniteAreNamedOrReplaced) {
  const Folder folder;
  std::string h = nifti1();
  put(h, 70, std::int16_t{16});
  std::vector<float> values = counting<float>();
  values[15] = std::numeric_limits<float>::quiet_NaN();  // (1, 1, 2)
  values[20] = -std::numeric_limits<float>::infinity();
  values[0] = 5;
  const auto path = folder.write("a.nii", h + bytes_of_values(values));
  try {
    read_image(path);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), "image.not_finite");
    EXPECT_THAT(error.what(), testing::HasSubstr("2 voxels"));
    EXPECT_THAT(error.what(), testing::HasSubstr("(1, 1, 2)"));
  }
  const Image image = read_image(path, {.raw = {}, .replace_non_finite = true});
  EXPECT_EQ(image.values[15], 1.0F);
  EXPECT_EQ(image.values[20], 1.0F);
}

TEST(NiftiRead, ALyingHeaderCostsNoMemory) {
  const Folder folder;
  std::string h = nifti1();
  for (const std::size_t offset : {42, 44, 46}) put(h, offset, std::int16_t{10000});
  EXPECT_EQ(refusal(folder.write("a.nii", h + kVoxels)), "image.truncated");
  EXPECT_EQ(refusal(folder.write("a.nii.gz", deflated(h + kVoxels))), "image.truncated");
  // Within the ratio that deflate can reach: only what arrives is kept.
  put(h, 42, std::int16_t{20}), put(h, 44, std::int16_t{20}), put(h, 46, std::int16_t{20});
  EXPECT_EQ(refusal(folder.write("a.nii.gz", deflated(h + kVoxels))), "image.truncated");
}

TEST(NiftiRead, ADamagedChecksumIsFound) {
  const Folder folder;
  std::string bytes = deflated(nifti1() + kVoxels);
  bytes[bytes.size() - 8] = static_cast<char>(bytes[bytes.size() - 8] ^ 1);
  EXPECT_EQ(refusal(folder.write("a.nii.gz", bytes)), "image.corrupt");
  EXPECT_EQ(refusal(folder.write("a.nii.gz", nifti1() + kVoxels)), "image.corrupt");
}

}  // namespace
}  // namespace periost
