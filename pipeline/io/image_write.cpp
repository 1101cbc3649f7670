#include "pipeline/io/image_write.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "pipeline/base/error.h"
#include "pipeline/base/file.h"
#include "pipeline/base/quantity.h"
#include "pipeline/io/gzip_write.h"
#include "pipeline/io/nifti_write.h"
#include "pipeline/io/text_header.h"

namespace periost {
namespace {

static_assert(std::endian::native == std::endian::little, "voxels are written as they lie in memory");

constexpr std::size_t kBlockBytes = std::size_t{1} << 22;

// The voxels to be written, of either kind.
struct Volume {
  const GridFrame& frame;
  VoxelType type;
  const char* data;
  std::size_t bytes() const { return frame.voxel_count() * bytes_of(type); }
};

// Writes in blocks, so that progress moves and a cancelled run ends soon. Sink is AtomicFile or GzipWriter.
template <class Sink>
void write_voxels(Sink& sink, const Volume& volume, const Context& context) {
  Progress progress(context, "writing voxels", volume.bytes());
  for (std::size_t begin = 0; begin < volume.bytes(); begin += kBlockBytes) {
    const std::size_t step = std::min(kBlockBytes, volume.bytes() - begin);
    sink.write(volume.data + begin, step);
    progress.step(step);
  }
}

void write_plain(const std::filesystem::path& path, std::string_view header, const Volume& volume,
                 std::string_view trailer, const Context& context) {
  AtomicFile file(path);
  file.write(header);
  write_voxels(file, volume, context);
  file.write(trailer);
  file.commit();
}

// Plus zero turns a negative zero into zero.
std::string text_of(Vec3 v, const char* separator) {
  return fmt::format("{}{}{}{}{}", to_text(v.x + 0.0), separator, to_text(v.y + 0.0), separator,
                     to_text(v.z + 0.0));
}

std::string_view nifti_bytes(const std::array<unsigned char, 352>& header) {
  return {reinterpret_cast<const char*>(header.data()), header.size()};
}

std::array<unsigned char, 352> checked_nifti_header(const std::filesystem::path& path, const Volume& volume) {
  const auto& dims = volume.frame.dims;
  if (*std::max_element(dims.begin(), dims.end()) > INT16_MAX) {
    throw Error(ErrorKind::kInput, "image.dims",
                fmt::format("'{}' cannot hold {} x {} x {} voxels: NIfTI-1 ends at 32767 along an axis",
                            path.filename().string(), dims[0], dims[1], dims[2]),
                "write .mha or .nrrd");
  }
  return nifti_header(volume.frame, volume.type);
}

void write_nifti(const std::filesystem::path& path, const Volume& volume, const Context& context) {
  write_plain(path, nifti_bytes(checked_nifti_header(path, volume)), volume, "", context);
}

void write_nifti_gz(const std::filesystem::path& path, const Volume& volume, const Context& context) {
  const auto header = checked_nifti_header(path, volume);
  AtomicFile file(path);
  GzipWriter gzip(file);
  gzip.write(header.data(), header.size());
  write_voxels(gzip, volume, context);
  gzip.finish();
  file.commit();
}

void write_metaimage(const std::filesystem::path& path, const Volume& volume, const Context& context) {
  const GridFrame& frame = volume.frame;
  const auto& axis = frame.direction.column;
  const std::string header = fmt::format(
      "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\nCompressedData = "
      "False\n"
      "TransformMatrix = {} {} {}\nOffset = {}\nCenterOfRotation = 0 0 0\n"
      "ElementSpacing = {}\nDimSize = {} {} {}\nElementType = {}\nElementDataFile = LOCAL\n",
      text_of(axis[0], " "), text_of(axis[1], " "), text_of(axis[2], " "), text_of(frame.origin, " "),
      text_of(frame.spacing, " "), frame.dims[0], frame.dims[1], frame.dims[2],
      volume.type == VoxelType::kUint8 ? "MET_UCHAR" : "MET_FLOAT");
  write_plain(path, header, volume, "", context);
}

void write_nrrd(const std::filesystem::path& path, const Volume& volume, const Context& context) {
  const GridFrame& frame = volume.frame;
  std::string steps;
  for (std::size_t a = 0; a < 3; ++a) {
    steps += fmt::format(" ({})", text_of(frame.direction.column[a] * frame.spacing[a], ","));
  }
  const std::string header = fmt::format(
      "NRRD0004\ntype: {}\ndimension: 3\nspace: left-posterior-superior\nsizes: {} {} {}\nspace "
      "directions:{}\n"
      "kinds: domain domain domain\n{}encoding: gzip\nspace origin: ({})\n\n",
      volume.type == VoxelType::kUint8 ? "uint8" : "float", frame.dims[0], frame.dims[1], frame.dims[2],
      steps, volume.type == VoxelType::kUint8 ? "" : "endian: little\n", text_of(frame.origin, ","));
  AtomicFile file(path);
  file.write(header);
  GzipWriter gzip(file);
  write_voxels(gzip, volume, context);
  gzip.finish();
  file.commit();
}

void write_vti(const std::filesystem::path& path, const Volume& volume, const Context& context) {
  const GridFrame& frame = volume.frame;
  std::string direction;  // row by row
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t a = 0; a < 3; ++a) {
      direction +=
          fmt::format("{}{}", row + a == 0 ? "" : " ", to_text(frame.direction.column[a][row] + 0.0));
    }
  }
  const std::string extent =
      fmt::format("0 {} 0 {} 0 {}", frame.dims[0] - 1, frame.dims[1] - 1, frame.dims[2] - 1);
  const bool is_mask = volume.type == VoxelType::kUint8;
  std::string header = fmt::format(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" "
      "header_type=\"UInt64\">\n<ImageData WholeExtent=\"{}\" Origin=\"{}\" Spacing=\"{}\" "
      "Direction=\"{}\">\n"
      "<Piece Extent=\"{}\">\n<PointData Scalars=\"{}\">\n<DataArray type=\"{}\" Name=\"{}\" "
      "format=\"appended\" "
      "offset=\"0\"/>\n</PointData>\n<CellData/>\n</Piece>\n</ImageData>\n<AppendedData encoding=\"raw\">\n_",
      extent, text_of(frame.origin, " "), text_of(frame.spacing, " "), direction, extent,
      is_mask ? "mask" : "value", is_mask ? "UInt8" : "Float32", is_mask ? "mask" : "value");
  const auto length = std::bit_cast<std::array<char, 8>>(std::uint64_t{volume.bytes()});
  header.append(length.begin(), length.end());
  write_plain(path, header, volume, "\n</AppendedData>\n</VTKFile>\n", context);
}

struct WriterRow {
  std::string_view ending;
  void (*write)(const std::filesystem::path&, const Volume&, const Context&);
};
constexpr WriterRow kWriters[] = {{".nii.gz", write_nifti_gz},
                                  {".nii", write_nifti},
                                  {".mha", write_metaimage},
                                  {".nrrd", write_nrrd},
                                  {".vti", write_vti}};

const WriterRow* find_writer(const std::filesystem::path& path) {
  const std::string name = lower_case(path.filename().string());
  const auto* found = std::find_if(std::begin(kWriters), std::end(kWriters), [&](const WriterRow& row) {
    return name.size() > row.ending.size() && name.ends_with(row.ending);
  });
  return found == std::end(kWriters) ? nullptr : found;
}

void write_volume(const std::filesystem::path& path, const Volume& volume, const Context& context) {
  const WriterRow* writer = find_writer(path);
  if (writer == nullptr) {
    throw Error(ErrorKind::kUsage, "image.format",
                fmt::format("'{}' does not have the ending of an image format that is written",
                            path.filename().string()),
                "endings are .nii .nii.gz .mha .nrrd .vti");
  }
  writer->write(path, volume, context);
}

}  // namespace

void write_image(const std::filesystem::path& path, const Image& image, const Context& context) {
  PERIOST_ASSERT(image.values.size() == image.frame.voxel_count());
  write_volume(path, {image.frame, VoxelType::kFloat32, reinterpret_cast<const char*>(image.values.data())},
               context);
}

void write_mask(const std::filesystem::path& path, const Mask& mask, const Context& context) {
  PERIOST_ASSERT(mask.inside.size() == mask.frame.voxel_count());
  write_volume(path, {mask.frame, VoxelType::kUint8, reinterpret_cast<const char*>(mask.inside.data())},
               context);
}

bool is_writable_image_format(const std::filesystem::path& path) {
  return find_writer(path) != nullptr;
}

}  // namespace periost
