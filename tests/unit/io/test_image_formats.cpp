// MetaImage, NRRD, Inrimage, VTI, InVesalius and raw files put together by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/io/image_files.h"

namespace periost {
namespace {

using namespace test;

const std::string kLittle = bytes_of_values(counting<std::int16_t>());
const std::string kBig = bytes_of_values(counting<std::int16_t>(), true);

// ---- MetaImage

std::string metaimage(const std::string& more, const std::string& data = "LOCAL") {
  return "ObjectType = Image\nNDims = 3\nBinaryData = True\nDimSize = 2 3 4\nElementType = MET_SHORT\n"
         "ElementSpacing = 0.5 2 3\nOffset = -10.5 20 30\n" +
         more + "ElementDataFile = " + data + "\n";
}

TEST(MetaImageRead, MatrixIsWrittenAxisByAxis) {
  const Folder folder;
  // i points to posterior, j to the right, k to superior.
  const Image image =
      read_image(folder.write("a.mha", metaimage("TransformMatrix = 0 1 0 -1 0 0 0 0 1\n") + kLittle));
  EXPECT_EQ(image.frame.origin, (Vec3{-10.5, 20, 30}));
  EXPECT_EQ(image.frame.to_lps({1, 0, 0}), (Vec3{-10.5, 20.5, 30}));
  EXPECT_EQ(image.frame.to_lps({0, 1, 0}), (Vec3{-12.5, 20, 30}));
  EXPECT_EQ(image.frame.to_lps({0, 0, 1}), (Vec3{-10.5, 20, 33}));
  EXPECT_EQ(image.values, counting<float>());
}

TEST(MetaImageRead, ByteOrderCompressionAndPlaceOfTheVoxels) {
  const Folder folder;
  const auto values = [&](const std::string& name, const std::string& bytes) {
    return read_image(folder.write(name, bytes)).values;
  };
  EXPECT_EQ(values("a.mha", metaimage("BinaryDataByteOrderMSB = True\n") + kBig), counting<float>());
  EXPECT_EQ(values("b.mha", metaimage("ElementByteOrderMSB = True\r\n") + kBig), counting<float>());
  EXPECT_EQ(
      values("c.mha", metaimage("CompressedData = True\nCompressedDataSize = 60\n") + deflated(kLittle, 15)),
      counting<float>());
  folder.write("d.raw", kLittle);
  EXPECT_EQ(values("d.mhd", metaimage("", "d.raw")), counting<float>());
  folder.write("sub/e.raw", "0123456789" + kLittle);
  EXPECT_EQ(values("e.mhd", metaimage("HeaderSize = 10\n", "sub/e.raw")), counting<float>());
  EXPECT_EQ(values("f.mhd", metaimage("HeaderSize = -1\n", "sub/e.raw")), counting<float>());
  folder.write("g.zraw", deflated(kLittle, 15));
  EXPECT_EQ(values("g.mhd", metaimage("CompressedData = True\n", "g.zraw")), counting<float>());
  EXPECT_EQ(values("h.mha",
                   metaimage("ElementToIntensityFunctionSlope = 2\nElementToIntensityFunctionOffset = -1\n") +
                       kLittle)[3],
            5.0F);
}

TEST(MetaImageRead, RefusesWhatItCannotRead) {
  const Folder folder;
  const auto refused = [&](const std::string& bytes) { return refusal(folder.write("a.mha", bytes)); };
  EXPECT_EQ(refused("hello\n"), "image.header");
  EXPECT_EQ(refused(""), "image.header");
  EXPECT_EQ(refused(metaimage("", "LIST\na.raw")), "image.header");
  EXPECT_EQ(refused(metaimage("", "a%03d.raw 1 4 1")), "image.header");
  EXPECT_EQ(refused(metaimage("", "../a.raw")), "image.path_escape");
  EXPECT_EQ(refused(metaimage("", "/etc/passwd")), "image.path_escape");
  EXPECT_EQ(refused(metaimage("", "sub/../../a.raw")), "image.path_escape");
  EXPECT_EQ(refused(metaimage("", "nosuch.raw")), "image.missing");
  EXPECT_EQ(refused(metaimage("") + kLittle.substr(1)), "image.truncated");
  EXPECT_EQ(refused(metaimage("CompressedData = True\n") + kLittle), "image.corrupt");
  EXPECT_EQ(refused(metaimage("NDims = 4\n") + kLittle), "image.dims");
  EXPECT_EQ(refused(metaimage("DimSize = 2 3\n") + kLittle), "image.header");
  EXPECT_EQ(refused(metaimage("DimSize = 2 3 4.5\n") + kLittle), "image.header");
  EXPECT_EQ(refused(metaimage("DimSize = 2 -3 4\n") + kLittle), "image.dims");
  EXPECT_EQ(refused(metaimage("DimSize = 2000000000 2000000000 2000000000\n") + kLittle), "image.dims");
  EXPECT_EQ(refused(metaimage("ElementSpacing = 0 1 1\n") + kLittle), "image.frame");
  EXPECT_EQ(refused(metaimage("ElementSpacing = nan 1 1\n") + kLittle), "image.frame");
  EXPECT_EQ(refused(metaimage("Offset = inf 1 1\n") + kLittle), "image.frame");
  EXPECT_EQ(refused(metaimage("TransformMatrix = 1 0 0 0.1 1 0 0 0 1\n") + kLittle), "image.frame");
  EXPECT_EQ(refused(metaimage("TransformMatrix = 0 0 0 0 0 0 0 0 0\n") + kLittle), "image.frame");
  EXPECT_EQ(refused(metaimage("ElementType = MET_SHORT_ARRAY\n") + kLittle), "image.type");
  EXPECT_EQ(refused(metaimage("ElementNumberOfChannels = 3\n") + kLittle), "image.type");
  EXPECT_EQ(refused(metaimage("BinaryData = False\n") + kLittle), "image.type");
}

// ---- NRRD

std::string nrrd(const std::string& more, const std::string& type = "short") {
  return "NRRD0004\n# a comment\ntype: " + type + "\ndimension: 3\nsizes: 2 3 4\nuser key:=user value\n" +
         more;
}
const std::string kRaw = "endian: little\nencoding: raw\n";
const std::string kSteps = "space directions: (0,0.5,0) (-2,0,0) (0,0,3)\nspace origin: (1,2,3)\n";

TEST(NrrdRead, SpacesBecomeLps) {
  const Folder folder;
  struct Row {
    const char* space;
    Vec3 sign;
  };
  for (const Row& row : {Row{"left-posterior-superior", {1, 1, 1}}, Row{"LPS", {1, 1, 1}},
                         Row{"right-anterior-superior", {-1, -1, 1}}, Row{"RAS", {-1, -1, 1}},
                         Row{"left-anterior-superior", {1, -1, 1}}, Row{"scanner-xyz", {1, 1, 1}}}) {
    const Image image = read_image(
        folder.write("a.nrrd", nrrd(kRaw + "space: " + row.space + "\n" + kSteps) + "\n" + kLittle));
    const auto lps = [&](double x, double y, double z) {
      return Vec3{x * row.sign.x, y * row.sign.y, z * row.sign.z};
    };
    EXPECT_EQ(image.frame.origin, lps(1, 2, 3)) << row.space;
    EXPECT_EQ(image.frame.to_lps({1, 0, 0}), lps(1, 2.5, 3)) << row.space;
    EXPECT_EQ(image.frame.to_lps({0, 1, 0}), lps(-1, 2, 3)) << row.space;
    EXPECT_EQ(image.frame.to_lps({0, 0, 1}), lps(1, 2, 6)) << row.space;
    EXPECT_EQ(image.values, counting<float>());
  }
}

TEST(NrrdRead, EncodingByteOrderAndPlaceOfTheVoxels) {
  const Folder folder;
  const auto values = [&](const std::string& name, const std::string& bytes) {
    return read_image(folder.write(name, bytes)).values;
  };
  EXPECT_EQ(values("a.nrrd", nrrd("endian: big\nencoding: raw\nspacings: 1 2 3\n") + "\n" + kBig),
            counting<float>());
  EXPECT_EQ(values("b.nrrd", nrrd("endian: little\nencoding: gzip\n") + "\n" + deflated(kLittle)),
            counting<float>());
  EXPECT_EQ(
      values("c.nrrd", nrrd("encoding: raw\n", "uchar") + "\n" + bytes_of_values(counting<std::uint8_t>())),
      counting<float>());
  folder.write("d.raw", "one line\nanother\nxyz" + kLittle);
  EXPECT_EQ(values("d.nhdr", nrrd(kRaw + "line skip: 2\nbyte skip: 3\ndata file: ./d.raw\n")),
            counting<float>());
  EXPECT_EQ(values("e.nhdr", nrrd(kRaw + "byteskip: -1\ndatafile: d.raw")), counting<float>());
  EXPECT_EQ(values("f.nrrd",
                   "NRRD0001\r\ntype: int16\r\ndimension: 3\r\nsizes: 2 3 4\r\nencoding: raw\r\n"
                   "endian: little\r\n\r\n" +
                       kLittle),
            counting<float>());
}

TEST(NrrdRead, UnitsAndSpacings) {
  const Folder folder;
  const GridFrame um = read_image_frame(folder.write(
      "a.nrrd", nrrd(kRaw + "space: LPS\nspace units: \"um\" \"um\" \"um\"\n" + kSteps) + "\n" + kLittle));
  EXPECT_NEAR(um.spacing.y, 0.002, 1e-15);
  EXPECT_NEAR(um.origin.z, 0.003, 1e-15);
  EXPECT_EQ(
      read_image_frame(folder.write("b.nrrd", nrrd(kRaw + "spacings: 0.25 2 3\n") + "\n" + kLittle)).spacing,
      (Vec3{0.25, 2, 3}));
}

TEST(NrrdRead, RefusesWhatItCannotRead) {
  const Folder folder;
  const auto refused = [&](const std::string& header, const std::string& data = kLittle) {
    return refusal(folder.write("a.nrrd", header + "\n" + data));
  };
  EXPECT_EQ(refusal(folder.write("a.nrrd", "")), "image.header");
  EXPECT_EQ(refusal(folder.write("a.nrrd", nrrd(kRaw))), "image.truncated");
  EXPECT_EQ(refused("NRRD0009x\n"), "image.header");
  EXPECT_EQ(refused(nrrd(kRaw + "no colon here\n")), "image.header");
  EXPECT_EQ(refused(nrrd(kRaw + "dimension: 4\n")), "image.dims");
  EXPECT_EQ(refused(nrrd(kRaw + "kinds: vector domain domain\n")), "image.dims");
  EXPECT_EQ(refused(nrrd(kRaw + "space directions: none (1,0,0) (0,1,0)\n")), "image.dims");
  EXPECT_EQ(refused(nrrd(kRaw + "space directions: (1,0,0) (0.2,1,0) (0,0,1)\n")), "image.frame");
  EXPECT_EQ(refused(nrrd(kRaw + "space: left-posterior-superior-time\n")), "image.frame");
  EXPECT_EQ(refused(nrrd(kRaw + "spacings: nan 1 1\n")), "image.frame");
  EXPECT_EQ(refused(nrrd(kRaw + "sizes: 2 3\n")), "image.header");
  EXPECT_EQ(refused(nrrd(kRaw + "sizes: 0 3 4\n")), "image.dims");
  EXPECT_EQ(refused(nrrd(kRaw + "space units: \"mm\" \"um\" \"mm\"\n")), "image.header");
  EXPECT_EQ(refused(nrrd("endian: middle\nencoding: raw\n")), "image.header");
  EXPECT_EQ(refused(nrrd("encoding: raw\n")), "image.header");
  EXPECT_EQ(refused(nrrd("endian: little\nencoding: ascii\n")), "image.type");
  EXPECT_EQ(refused(nrrd(kRaw, "block")), "image.type");
  EXPECT_EQ(refused(nrrd("endian: little\nencoding: gzip\n")), "image.corrupt");
  EXPECT_EQ(refused(nrrd(kRaw), kLittle.substr(1)), "image.truncated");
  EXPECT_EQ(refused(nrrd(kRaw + "data file: ../x.raw\n")), "image.path_escape");
  EXPECT_EQ(refused(nrrd(kRaw + "data file: x.raw\n")), "image.missing");
  EXPECT_EQ(refused(nrrd(kRaw + "data file: LIST\nx.raw\n")), "image.header");
  EXPECT_EQ(refused(nrrd(kRaw + "byte skip: -2\n")), "image.header");
  EXPECT_EQ(refused(nrrd(kRaw + "line skip: 1000\n")), "image.truncated");
}

// ---- Inrimage

std::string inrimage(const std::string& more, const std::string& cpu = "decm") {
  std::string header =
      "#INRIMAGE-4#{\nXDIM=2\nYDIM=3\nZDIM=4\nVDIM=1\nTYPE=signed fixed\nPIXSIZE=16 bits\n"
      "SCALE=2**0\nCPU=" +
      cpu + "\nVX=0.5\nVY=2\nVZ=3\n" + more;
  return header + std::string(256 - 4 - header.size() % 256, '\n') + "##}\n";
}

TEST(InrimageRead, HeaderOfWholeBlocks) {
  const Folder folder;
  const Image image = read_image(folder.write("a.inr", inrimage("TX=1\nTY=2\nTZ=3\n") + kLittle));
  EXPECT_EQ(image.frame.spacing, (Vec3{0.5, 2, 3}));
  EXPECT_EQ(image.frame.origin, (Vec3{1, 2, 3}));
  EXPECT_EQ(image.values, counting<float>());
  EXPECT_EQ(read_image(folder.write("b.inr", inrimage("", "sun") + kBig)).values, counting<float>());
  EXPECT_EQ(read_image(folder.write("c.inr.gz", deflated(inrimage("") + kLittle))).values, counting<float>());
}

TEST(InrimageRead, RefusesWhatItCannotRead) {
  const Folder folder;
  const auto refused = [&](const std::string& bytes) { return refusal(folder.write("a.inr", bytes)); };
  EXPECT_EQ(refused(""), "image.header");
  EXPECT_EQ(refused(inrimage("").substr(0, 200)), "image.truncated");
  EXPECT_EQ(refused(inrimage("") + kLittle.substr(1)), "image.truncated");
  EXPECT_EQ(refused(inrimage("VDIM=3\n") + kLittle), "image.type");
  EXPECT_EQ(refused(inrimage("PIXSIZE=12 bits\n") + kLittle), "image.type");
  EXPECT_EQ(refused(inrimage("", "vax") + kLittle), "image.header");
  EXPECT_EQ(refused(inrimage("RX=0.1\n") + kLittle), "image.frame");
  EXPECT_EQ(refused(inrimage("VX=0\n") + kLittle), "image.frame");
}

// ---- VTI

std::string vti(const std::string& extent, const std::string& values) {
  return "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\">\n"
         "<ImageData WholeExtent=\"" +
         extent +
         "\" Origin=\"1 2 3\" Spacing=\"0.5 2 3\" "
         "Direction=\"0 -1 0 1 0 0 0 0 1\">\n<Piece Extent=\"" +
         extent +
         "\">\n<PointData Scalars=\"v\">\n"
         "<DataArray type=\"Int16\" Name=\"v\" format=\"ascii\">" +
         values + "</DataArray>\n</PointData>\n</Piece>\n</ImageData>\n</VTKFile>\n";
}
const std::string kCount = "0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23";

TEST(VtiRead, ExtentGoesIntoTheOriginAndTheMatrixIsKept) {
  const Folder folder;
  const Image image = read_image(folder.write("a.vti", vti("10 11 -2 0 5 8", kCount)));
  EXPECT_EQ(image.frame.dims, (std::array<std::int32_t, 3>{2, 3, 4}));
  // i points to posterior, j to the right: the first point is 10 steps along i, -2 along j, 5 along k.
  EXPECT_EQ(image.frame.origin, (Vec3{1 + 4, 2 + 5, 3 + 15}));
  EXPECT_EQ(image.frame.to_lps({1, 1, 1}) - image.frame.origin, (Vec3{-2, 0.5, 3}));
  EXPECT_EQ(image.values, counting<float>());
}

TEST(VtiRead, RefusesWhatItCannotRead) {
  const Folder folder;
  const auto refused = [&](const std::string& bytes) { return refusal(folder.write("a.vti", bytes)); };
  EXPECT_EQ(refused(""), "image.header");
  EXPECT_EQ(refused("<VTKFile type=\"PolyData\"/>"), "image.header");
  EXPECT_NE(refused(vti("0 1 0 2 0 3", kCount).substr(0, 300)), "");
  EXPECT_EQ(refused(vti("0 1 0 2 0 -1", kCount)), "image.dims");
  EXPECT_EQ(refused(vti("0 2000 0 2000 0 2000", kCount)), "image.truncated");
  EXPECT_NE(refused(vti("0 1 0 2 0 3", "0 1 2")), "");
}

// ---- InVesalius

std::string plist(const std::string& shape = "<integer>4</integer><integer>3</integer><integer>2</integer>") {
  return "<?xml version=\"1.0\"?>\n<!DOCTYPE plist PUBLIC \"x\" \"y\">\n<plist version=\"1.0\"><dict>"
         "<key>name</key><string>Jane Doe</string><key>masks</key><dict/>"
         "<key>matrix</key><dict><key>dtype</key><string>int16</string><key>filename</"
         "key><string>matrix.dat</string>"
         "<key>shape</key><array>" +
         shape +
         "</array></dict>"
         "<key>spacing</key><array><real>0.5</real><real>2</real><real>3</real></array></dict></plist>";
}
const std::string kEnd(1024, '\0');

TEST(Inv3Read, MatrixIsFoundWhereverItLies) {
  const Folder folder;
  const std::string top = tar_entry("top/", "", '5');
  const std::string main = tar_entry("top/main.plist", plist());
  const std::string matrix = tar_entry("top/matrix.dat", kLittle);
  const std::string other = tar_entry("top/mask_0.dat", std::string(700, 'm'));
  for (const std::string& archive : {top + main + other + matrix, matrix + other + main, main + matrix}) {
    for (const bool is_compressed : {false, true}) {
      const std::string bytes = archive + kEnd;
      const Image image = read_image(folder.write("a.inv3", is_compressed ? deflated(bytes) : bytes));
      EXPECT_EQ(image.frame.dims, (std::array<std::int32_t, 3>{2, 3, 4}));
      EXPECT_EQ(image.frame.to_lps({1, 1, 1}), (Vec3{0.5, -2, 3}));
      EXPECT_EQ(image.values, counting<float>());
    }
  }
}

TEST(Inv3Read, RefusesWhatItCannotRead) {
  const Folder folder;
  const std::string main = tar_entry("top/main.plist", plist());
  const std::string matrix = tar_entry("top/matrix.dat", kLittle);
  const auto refused = [&](const std::string& bytes) {
    return refusal(folder.write("a.inv3", deflated(bytes)));
  };
  EXPECT_EQ(refused(""), "image.header");
  EXPECT_EQ(refused(std::string(600, 'x')), "image.header");
  EXPECT_EQ(refused(matrix + kEnd), "image.header");
  EXPECT_EQ(refused(main + kEnd), "image.header");
  EXPECT_EQ(refused(main + tar_entry("top/matrix.dat", kLittle.substr(2)) + kEnd), "image.truncated");
  EXPECT_EQ(refused(main + matrix.substr(0, 520)), "image.truncated");
  EXPECT_EQ(refused(tar_entry("top/main.plist", "<plist><dict>") + matrix + kEnd), "image.header");
  EXPECT_EQ(refused(tar_entry("top/main.plist", plist("<integer>4</integer>")) + matrix + kEnd),
            "image.header");
  std::string deep;
  for (int n = 0; n < 100; ++n) deep += "<array>";
  EXPECT_EQ(refused(tar_entry("top/main.plist", plist(deep)) + matrix + kEnd), "image.header");
  std::string lying = matrix;
  put_text(lying, 124, "77777777777");
  EXPECT_EQ(refused(lying + kEnd), "image.header");  // its checksum is wrong now
  // A link is no file, whatever it points to.
  EXPECT_EQ(refused(main + tar_entry("top/matrix.dat", "", '2') + kEnd), "image.header");
}

TEST(Inv3Read, NameIsNeverSaid) {
  const Folder folder;
  std::string said;
  Context context;
  context.sink = [&](const Event& event) { said += event.text; };
  read_image(
      folder.write("a.inv3", tar_entry("t/main.plist", plist()) + tar_entry("t/matrix.dat", kLittle) + kEnd),
      {}, context);
  EXPECT_THAT(said, testing::HasSubstr("assumed"));
  EXPECT_THAT(said, testing::Not(testing::HasSubstr("Jane")));
}

// ---- raw, and what is no image

TEST(RawRead, IsDescribedByOptions) {
  const Folder folder;
  ImageFileOptions options;
  options.raw = RawImageOptions{.dims = {2, 3, 4},
                                .type = VoxelType::kInt16,
                                .spacing = {0.5, 2, 3},
                                .origin = {1, 2, 3},
                                .direction = {0, 1, 0, -1, 0, 0, 0, 0, 1},
                                .endian = ByteOrder::kBig,
                                .header_bytes = 5};
  const Image image = read_image(folder.write("a.bin", "12345" + kBig), options);
  EXPECT_EQ(image.frame.to_lps({1, 1, 1}), (Vec3{-1, 2.5, 6}));
  EXPECT_EQ(image.values, counting<float>());
  EXPECT_EQ(refusal(folder.write("b.bin", kBig), options), "image.truncated");
  EXPECT_EQ(refusal(folder.write("c.bin", "123456" + kBig), options), "image.dims");
  options.raw->dims[1] = 0;
  EXPECT_EQ(refusal(folder.write("a.bin", "12345" + kBig), options), "image.dims");
}

TEST(ImageRead, SaysWhatIsNoImage) {
  const Folder folder;
  EXPECT_EQ(refusal(folder.path() / "nosuch.nii"), "image.missing");
  EXPECT_EQ(refusal(folder.path()), "image.dicom");
  EXPECT_EQ(refusal(folder.write("a.dcm", "x")), "image.dicom");
  EXPECT_EQ(refusal(folder.write("IM0001", std::string(128, '\0') + "DICM")), "image.dicom");
  EXPECT_EQ(refusal(folder.write("a.txt", "x")), "image.format");
}

// Every file cut short at any byte, and with any one byte changed, is read or refused, never more.
TEST(ImageRead, NoDamageMakesItFail) {
  const Folder folder;
  std::string sform = nifti1();
  put(sform, 254, std::int16_t{1});
  const std::array<float, 12> rows{1, 0, 0, 10, 0, 2, 0, 20, 0, 0, 3, 30};
  for (std::size_t n = 0; n < 12; ++n) put(sform, 280 + 4 * n, rows[n]);
  const std::vector<std::pair<std::string, std::string>> corpus{
      {"a.nii", sform + kLittle},
      {"a.nii.gz", deflated(sform + kLittle)},
      {"a.mha", metaimage("TransformMatrix = 0 1 0 -1 0 0 0 0 1\n") + kLittle},
      {"z.mha", metaimage("CompressedData = True\n") + deflated(kLittle, 15)},
      {"a.nrrd", nrrd(kRaw + "space: RAS\n" + kSteps) + "\n" + kLittle},
      {"z.nrrd", nrrd("endian: big\nencoding: gzip\n") + "\n" + deflated(kBig)},
      {"a.inr", inrimage("TX=1\n") + kLittle},
      {"a.inv3", deflated(tar_entry("t/main.plist", plist()) + tar_entry("t/matrix.dat", kLittle) + kEnd)},
      {"b.inv3", tar_entry("t/main.plist", plist()) + tar_entry("t/matrix.dat", kLittle) + kEnd}};
  for (const auto& [name, bytes] : corpus) {
    ASSERT_EQ(refusal(folder.write(name, bytes)), "") << name;
    for (std::size_t end = 0; end < bytes.size(); ++end) {
      const std::string code = refusal(folder.write(name, bytes.substr(0, end)));
      EXPECT_TRUE(code.empty() || code.starts_with("image.")) << name << " cut at " << end << ": " << code;
    }
    for (std::size_t at = 0; at < bytes.size(); ++at) {
      for (const char flip : {'\x01', '\x80', '\xff'}) {
        std::string changed = bytes;
        changed[at] = static_cast<char>(changed[at] ^ flip);
        const std::string code = refusal(folder.write(name, changed));
        EXPECT_TRUE(code.empty() || code.starts_with("image.")) << name << " byte " << at << ": " << code;
      }
    }
  }
}

}  // namespace
}  // namespace periost
