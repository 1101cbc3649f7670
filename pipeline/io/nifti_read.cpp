// NIfTI-1 and NIfTI-2: https://nifti.nimh.nih.gov/nifti-1/documentation and nifti2.h. Both headers are read
// through one table of byte offsets. NIfTI's frame is RAS: x and y change sign.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "pipeline/io/image_layout.h"

namespace periost {
namespace {

// Byte offsets of the fields that are used.
struct FieldTable {
  std::size_t header_bytes;
  std::size_t magic, dim, datatype, pixdim, vox_offset, scl_slope, scl_inter, qform_code, sform_code, quatern,
      qoffset, srow, xyzt_units;
  bool is_version_2;  // 64-bit sizes and double precision
};
constexpr FieldTable kVersion1{348, 344, 40, 70, 76, 108, 112, 116, 252, 254, 256, 268, 280, 123, false};
constexpr FieldTable kVersion2{540, 4, 16, 12, 104, 168, 176, 184, 344, 348, 352, 376, 400, 500, true};

struct TypeRow {
  int code;
  VoxelType type;
};
constexpr std::array<TypeRow, 10> kTypes{{{2, VoxelType::kUint8},
                                          {4, VoxelType::kInt16},
                                          {8, VoxelType::kInt32},
                                          {16, VoxelType::kFloat32},
                                          {64, VoxelType::kFloat64},
                                          {256, VoxelType::kInt8},
                                          {512, VoxelType::kUint16},
                                          {768, VoxelType::kUint32},
                                          {1024, VoxelType::kInt64},
                                          {1280, VoxelType::kUint64}}};

struct NotReadRow {
  int code;
  std::string_view what;
};
constexpr std::array<NotReadRow, 7> kNotRead{{{1, "single bits"},
                                              {32, "complex numbers"},
                                              {128, "RGB colours"},
                                              {1536, "128-bit floats"},
                                              {1792, "complex numbers"},
                                              {2048, "complex numbers"},
                                              {2304, "RGBA colours"}}};

class Header {
 public:
  Header(const FieldTable& fields, bool is_big_endian, std::array<unsigned char, 540> bytes)
      : fields_(fields), is_big_endian_(is_big_endian), bytes_(bytes) {}

  template <class T>
  T at(std::size_t offset) const {
    std::array<unsigned char, sizeof(T)> raw{};
    std::copy_n(bytes_.begin() + static_cast<std::ptrdiff_t>(offset), sizeof(T), raw.begin());
    if (is_big_endian_) std::reverse(raw.begin(), raw.end());
    return std::bit_cast<T>(raw);
  }
  // Entry n of a field whose type depends on the version.
  double real(std::size_t offset, std::size_t n = 0) const {
    return fields_.is_version_2 ? at<double>(offset + 8 * n) : static_cast<double>(at<float>(offset + 4 * n));
  }
  std::int64_t size(std::size_t n) const {
    return fields_.is_version_2 ? at<std::int64_t>(fields_.dim + 8 * n)
                                : at<std::int16_t>(fields_.dim + 2 * n);
  }
  int code(std::size_t offset) const {
    return fields_.is_version_2 ? at<std::int32_t>(offset) : at<std::int16_t>(offset);
  }
  int units() const {
    return fields_.is_version_2 ? at<std::int32_t>(fields_.xyzt_units) : bytes_[fields_.xyzt_units];
  }
  char magic(std::size_t n) const { return static_cast<char>(bytes_[fields_.magic + n]); }
  const FieldTable& fields() const { return fields_; }
  bool is_big_endian() const { return is_big_endian_; }

 private:
  const FieldTable& fields_;
  bool is_big_endian_;
  std::array<unsigned char, 540> bytes_;
};

Header read_header(const std::filesystem::path& path, ByteSource& source) {
  std::array<unsigned char, 540> bytes{};
  source.read_exactly(bytes.data(), 348, "NIfTI header");
  std::uint32_t little = 0;
  std::memcpy(&little, bytes.data(), 4);
  const std::uint32_t big = __builtin_bswap32(little);
  if (little == 540 || big == 540) source.read_exactly(bytes.data() + 348, 540 - 348, "NIfTI-2 header");
  const bool is_nifti = little == 348 || big == 348 || little == 540 || big == 540;
  const FieldTable& fields = little == 540 || big == 540 ? kVersion2 : kVersion1;
  Header header(fields, big == 348 || big == 540, bytes);
  const bool has_magic = header.magic(0) == 'n' && (header.magic(1) == '+' || header.magic(1) == 'i') &&
                         header.magic(2) == (fields.is_version_2 ? '2' : '1');
  if (!is_nifti || !has_magic) {
    refuse_file(path, "image.header",
                is_nifti ? "has no NIfTI magic at byte 344: it may be an Analyze 7.5 file"
                         : "is not a NIfTI file: its first four bytes are not a header size of 348 or 540",
                is_nifti ? "Analyze files do not state an orientation; convert it to NIfTI"
                         : "check the file's type");
  }
  return header;
}

std::array<std::int32_t, 3> dims_of(const std::filesystem::path& path, const Header& header) {
  const std::int64_t axes = header.size(0);
  if (axes < 3 || axes > 7) {
    refuse_file(path, "image.dims", fmt::format("has {} axes (dim[0]); a volume of three is needed", axes));
  }
  for (std::size_t a = 4; a <= static_cast<std::size_t>(axes); ++a) {
    if (header.size(a) > 1) {
      refuse_file(
          path, "image.dims",
          fmt::format("holds {} volumes or components along axis {}; one is needed", header.size(a), a),
          "split it first and give one volume");
    }
  }
  return checked_dims(path, {header.size(1), header.size(2), header.size(3)});
}

double mm_per_unit(const std::filesystem::path& path, int code) {
  switch (code & 7) {
    case 0:
    case 2:
      return 1;
    case 1:
      return 1000;
    case 3:
      return 0.001;
    default:
      refuse_file(path, "image.header", fmt::format("has an unknown unit of length (xyzt_units {})", code));
  }
}

// The affine in RAS as three steps and an origin, in the file's own unit.
struct Affine {
  std::array<Vec3, 3> step;
  Vec3 origin;
};

Affine sform_of(const Header& header) {
  Affine affine;
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t a = 0; a < 3; ++a) affine.step[a][row] = header.real(header.fields().srow, 4 * row + a);
    affine.origin[row] = header.real(header.fields().srow, 4 * row + 3);
  }
  return affine;
}

// The rotation of the unit quaternion (a, b, c, d), by columns.
std::array<Vec3, 3> rotation_of(double b, double c, double d) {
  const double rest = 1 - (b * b + c * c + d * d);
  double a = 0;
  if (rest > 1e-7) {
    a = std::sqrt(rest);
  } else {  // a half turn, written with rounded numbers
    const double length = std::sqrt(b * b + c * c + d * d);
    b /= length, c /= length, d /= length;
  }
  return {Vec3{a * a + b * b - c * c - d * d, 2 * (b * c + a * d), 2 * (b * d - a * c)},
          Vec3{2 * (b * c - a * d), a * a + c * c - b * b - d * d, 2 * (c * d + a * b)},
          Vec3{2 * (b * d + a * c), 2 * (c * d - a * b), a * a + d * d - b * b - c * c}};
}

Affine qform_of(const Header& header) {
  const FieldTable& fields = header.fields();
  Affine affine;
  affine.step = rotation_of(header.real(fields.quatern, 0), header.real(fields.quatern, 1),
                            header.real(fields.quatern, 2));
  const double qfac = header.real(fields.pixdim, 0) < 0 ? -1 : 1;
  for (std::size_t a = 0; a < 3; ++a) {
    affine.step[a] = affine.step[a] * (std::abs(header.real(fields.pixdim, a + 1)) * (a == 2 ? qfac : 1));
    affine.origin[a] = header.real(fields.qoffset, a);
  }
  return affine;
}

Affine pixdim_of(const Header& header) {
  Affine affine;
  for (std::size_t a = 0; a < 3; ++a)
    affine.step[a][a] = std::abs(header.real(header.fields().pixdim, a + 1));
  return affine;
}

GridFrame frame_of(const std::filesystem::path& path, const Header& header, std::vector<std::string>& notes) {
  const bool has_sform = header.code(header.fields().sform_code) > 0;
  const bool has_qform = header.code(header.fields().qform_code) > 0;
  Affine affine = has_sform ? sform_of(header) : has_qform ? qform_of(header) : pixdim_of(header);
  if (!has_sform && !has_qform) {
    notes.emplace_back(
        "the NIfTI file states no orientation (sform and qform codes are 0): axes R A S and origin 0 "
        "assumed");
  }
  const double scale = mm_per_unit(path, header.units());
  const auto to_lps = [scale](Vec3 ras) { return Vec3{-ras.x * scale, -ras.y * scale, ras.z * scale}; };
  for (Vec3& step : affine.step) step = to_lps(step);
  return frame_from_steps(path, dims_of(path, header), affine.step, to_lps(affine.origin));
}

VoxelType type_of(const std::filesystem::path& path, int code) {
  for (const TypeRow& row : kTypes) {
    if (row.code == code) return row.type;
  }
  for (const NotReadRow& row : kNotRead) {
    if (row.code == code) {
      refuse_file(path, "image.type",
                  fmt::format("holds {} (datatype {}); grey values are needed", row.what, code));
    }
  }
  refuse_file(path, "image.type", fmt::format("has an unknown datatype {}", code));
}

// Of a pair, the file with the voxels: .img or .img.gz beside the .hdr.
std::filesystem::path image_of_pair(const std::filesystem::path& path) {
  std::filesystem::path image = path;
  if (image.extension() == ".gz") image.replace_extension();
  image.replace_extension(".img");
  for (const char* more : {"", ".gz"}) {
    std::filesystem::path candidate = image.string() + more;
    if (std::filesystem::exists(candidate)) return candidate;
  }
  refuse_file(path, "image.missing",
              fmt::format("is the header of a pair, but '{}' is not beside it", image.filename().string()));
}

void set_scaling(const std::filesystem::path& path, const Header& header, ImageLayout& layout) {
  const double slope = header.real(header.fields().scl_slope);
  const double intercept = header.real(header.fields().scl_inter);
  if (slope == 0 || std::isnan(slope)) return;
  if (!std::isfinite(slope) || !std::isfinite(intercept)) {
    refuse_file(path, "image.header",
                fmt::format("has a scaling that is not finite (slope {}, intercept {})", slope, intercept));
  }
  layout.slope = slope;
  layout.intercept = intercept;
}

}  // namespace

ImageLayout nifti_layout(const std::filesystem::path& path) {
  ByteSource source(path, path.extension() == ".gz" ? Coding::kDeflated : Coding::kAuto);
  const Header header = read_header(path, source);
  const FieldTable& fields = header.fields();
  ImageLayout layout;
  layout.format = fields.is_version_2 ? "NIfTI-2" : "NIfTI-1";
  layout.frame = frame_of(path, header, layout.notes);
  layout.type = type_of(path, header.at<std::int16_t>(fields.datatype));
  layout.is_big_endian = header.is_big_endian();
  set_scaling(path, header, layout);

  const bool is_pair = header.magic(1) == 'i';
  const double offset = fields.is_version_2 ? static_cast<double>(header.at<std::int64_t>(fields.vox_offset))
                                            : header.real(fields.vox_offset);
  const double least = is_pair ? 0 : static_cast<double>(fields.header_bytes + 4);
  if (!(offset == 0 || (offset >= least && offset < 1e15 && offset == std::floor(offset)))) {
    refuse_file(path, "image.header",
                fmt::format("says that its voxels begin at byte {}, which cannot be", offset));
  }
  layout.decoded_offset = static_cast<std::uint64_t>(std::max(offset, least));
  layout.data_file = is_pair ? image_of_pair(path) : path;
  return layout;
}

}  // namespace periost
