// Inrimage (.inr, .inr.gz): a text header of whole 256-byte blocks that ends in "##}", then the voxels. The
// format knows spacing and a translation, but no anatomical frame.
#include <fmt/format.h>

#include <map>

#include "pipeline/io/image_layout.h"
#include "pipeline/io/text_header.h"

namespace periost {
namespace {

constexpr std::size_t kBlock = 256;

using Fields = std::map<std::string, std::string, std::less<>>;

struct TypeRow {
  std::string_view type;
  std::string_view bits;
  VoxelType voxel;
};
constexpr std::array<TypeRow, 8> kTypes{{{"unsigned fixed", "8 bits", VoxelType::kUint8},
                                         {"unsigned fixed", "16 bits", VoxelType::kUint16},
                                         {"unsigned fixed", "32 bits", VoxelType::kUint32},
                                         {"signed fixed", "8 bits", VoxelType::kInt8},
                                         {"signed fixed", "16 bits", VoxelType::kInt16},
                                         {"signed fixed", "32 bits", VoxelType::kInt32},
                                         {"float", "32 bits", VoxelType::kFloat32},
                                         {"float", "64 bits", VoxelType::kFloat64}}};

struct CpuRow {
  std::string_view name;
  bool is_big_endian;
};
constexpr std::array<CpuRow, 5> kCpus{
    {{"decm", false}, {"alpha", false}, {"pc", false}, {"sun", true}, {"sgi", true}}};

Fields read_fields(const std::filesystem::path& path, std::size_t& header_bytes) {
  const std::string head = read_head(path);
  if (!head.starts_with("#INRIMAGE-4#{")) {
    refuse_file(path, "image.header", "is not an Inrimage: it does not begin with '#INRIMAGE-4#{'");
  }
  Fields fields;
  std::size_t at = 0;
  std::string_view line;
  while (next_line(head, at, line)) {
    if (line.starts_with("##}")) {
      header_bytes = (at + kBlock - 1) / kBlock * kBlock;
      return fields;
    }
    const std::size_t equals = line.find('=');
    if (equals != std::string_view::npos && !line.starts_with('#')) {
      fields.insert_or_assign(std::string(trimmed(line.substr(0, equals))),
                              std::string(trimmed(line.substr(equals + 1))));
    }
  }
  refuse_file(path, "image.truncated", "ends within its header: no line '##}' was found");
}

std::string value_of(const Fields& fields, std::string_view key, std::string_view otherwise) {
  const auto found = fields.find(key);
  return std::string(found == fields.end() ? otherwise : std::string_view(found->second));
}

Vec3 three(const std::filesystem::path& path, const Fields& fields, std::string_view letter,
           std::string_view otherwise) {
  Vec3 result;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::string key = fmt::format("{}{}", letter, "XYZ"[a]);
    result[a] = numbers_in(path, key, value_of(fields, key, otherwise), 1)[0];
  }
  return result;
}

GridFrame frame_of(const std::filesystem::path& path, const Fields& fields) {
  std::array<std::int64_t, 3> dims{};
  for (std::size_t a = 0; a < 3; ++a) {
    const std::string key = fmt::format("{}DIM", "XYZ"[a]);
    dims[a] = integers_in(path, key, value_of(fields, key, "0"), 1)[0];
  }
  if (value_of(fields, "VDIM", "1") != "1") {
    refuse_file(path, "image.type", "holds vectors; grey values are needed");
  }
  if (three(path, fields, "R", "0") != Vec3{}) {
    refuse_file(path, "image.frame", "states a rotation (RX, RY, RZ), which is not read");
  }
  const Vec3 spacing = three(path, fields, "V", "1");
  return frame_from_steps(path, checked_dims(path, dims),
                          {Vec3{spacing.x, 0, 0}, Vec3{0, spacing.y, 0}, Vec3{0, 0, spacing.z}},
                          three(path, fields, "T", "0"));
}

VoxelType type_of(const std::filesystem::path& path, const Fields& fields) {
  const std::string type = value_of(fields, "TYPE", "");
  const std::string bits = value_of(fields, "PIXSIZE", "");
  for (const TypeRow& row : kTypes) {
    if (row.type == type && row.bits == bits) return row.voxel;
  }
  refuse_file(path, "image.type",
              fmt::format("has voxels of type '{}' of '{}', which is not read", type, bits));
}

bool is_big_endian(const std::filesystem::path& path, const Fields& fields) {
  const std::string cpu = value_of(fields, "CPU", "");
  for (const CpuRow& row : kCpus) {
    if (row.name == cpu) return row.is_big_endian;
  }
  refuse_file(path, "image.header",
              fmt::format("names an unknown CPU '{}', so the order of bytes is unknown", cpu));
}

}  // namespace

ImageLayout inrimage_layout(const std::filesystem::path& path) {
  std::size_t header_bytes = 0;
  const Fields fields = read_fields(path, header_bytes);
  ImageLayout layout;
  layout.format = "Inrimage";
  layout.frame = frame_of(path, fields);
  layout.type = type_of(path, fields);
  layout.is_big_endian = is_big_endian(path, fields);
  layout.data_file = path;
  layout.decoded_offset = header_bytes;
  layout.notes.emplace_back("an Inrimage states no orientation: axes L P S assumed");
  return layout;
}

}  // namespace periost
