// MetaImage (.mha, .mhd): https://itk.org/Wiki/MetaIO/Documentation. Its frame is LPS millimetres. The matrix
// is written axis by axis: the first three numbers are the direction of i.
#include <fmt/format.h>

#include <map>
#include <optional>

#include "pipeline/io/image_layout.h"
#include "pipeline/io/text_header.h"

namespace periost {
namespace {

struct TypeRow {
  std::string_view name;
  VoxelType type;
};
// LONG is 32 bits on every platform.
constexpr std::array<TypeRow, 12> kTypes{{{"MET_CHAR", VoxelType::kInt8},
                                          {"MET_UCHAR", VoxelType::kUint8},
                                          {"MET_SHORT", VoxelType::kInt16},
                                          {"MET_USHORT", VoxelType::kUint16},
                                          {"MET_INT", VoxelType::kInt32},
                                          {"MET_UINT", VoxelType::kUint32},
                                          {"MET_LONG", VoxelType::kInt32},
                                          {"MET_ULONG", VoxelType::kUint32},
                                          {"MET_LONG_LONG", VoxelType::kInt64},
                                          {"MET_ULONG_LONG", VoxelType::kUint64},
                                          {"MET_FLOAT", VoxelType::kFloat32},
                                          {"MET_DOUBLE", VoxelType::kFloat64}}};

struct Header {
  std::map<std::string, std::string, std::less<>> fields;  // by lower-case key
  std::size_t bytes = 0;                                   // up to and with the line of ElementDataFile
};

Header read_header(const std::filesystem::path& path) {
  const std::string head = read_head(path);
  Header header;
  std::string_view line;
  while (next_line(head, header.bytes, line)) {
    const std::size_t equals = line.find('=');
    if (equals == std::string_view::npos) break;
    const std::string key = lower_case(trimmed(line.substr(0, equals)));
    header.fields.insert_or_assign(key, std::string(trimmed(line.substr(equals + 1))));
    if (key == "elementdatafile") return header;
  }
  // A detached header may lack the last line feed.
  const std::string_view rest = std::string_view(head).substr(header.bytes);
  if (lower_case(rest).starts_with("elementdatafile") && rest.find('=') != std::string_view::npos) {
    header.fields["elementdatafile"] = trimmed(rest.substr(rest.find('=') + 1));
    header.bytes = head.size();
    return header;
  }
  refuse_file(
      path, "image.header",
      fmt::format(
          "is not a MetaImage: after byte {} there is no line 'Key = value', and no ElementDataFile came "
          "before",
          header.bytes));
}

// The value of the first of several synonyms.
std::optional<std::string> value_of(const Header& header, std::initializer_list<std::string_view> keys) {
  for (const std::string_view key : keys) {
    const auto found = header.fields.find(key);
    if (found != header.fields.end()) return found->second;
  }
  return std::nullopt;
}

std::string need(const std::filesystem::path& path, const Header& header, std::string_view key) {
  const auto value = value_of(header, {lower_case(key)});
  if (!value) refuse_file(path, "image.header", fmt::format("lacks '{}' in its header", key));
  return *value;
}

bool is_true(const Header& header, std::initializer_list<std::string_view> keys) {
  const std::string text = lower_case(value_of(header, keys).value_or("false"));
  return text.starts_with('t') || text == "1" || text.starts_with('y');
}

VoxelType type_of(const std::filesystem::path& path, const std::string& name) {
  for (const TypeRow& row : kTypes) {
    if (row.name == name) return row.type;
  }
  refuse_file(path, "image.type", fmt::format("has voxels of type '{}'; grey values are needed", name));
}

double mm_per_unit(const std::filesystem::path& path, const Header& header) {
  const std::string unit = lower_case(value_of(header, {"distanceunits"}).value_or("mm"));
  if (unit == "mm" || unit == "?" || unit.empty()) return 1;
  if (unit == "um") return 0.001;
  if (unit == "cm") return 10;
  refuse_file(path, "image.header", fmt::format("has an unknown unit of length '{}'", unit));
}

GridFrame frame_of(const std::filesystem::path& path, const Header& header, std::vector<std::string>& notes) {
  const auto dims = integers_in(path, "DimSize", need(path, header, "DimSize"), 3);
  const auto spacing = numbers_in(path, "ElementSpacing",
                                  value_of(header, {"elementspacing", "elementsize"}).value_or("1 1 1"), 3);
  const auto origin =
      numbers_in(path, "Offset", value_of(header, {"offset", "position", "origin"}).value_or("0 0 0"), 3);
  const auto matrix_text = value_of(header, {"transformmatrix", "rotation", "orientation"});
  const auto matrix = numbers_in(path, "TransformMatrix", matrix_text.value_or("1 0 0 0 1 0 0 0 1"), 9);
  if (!matrix_text) notes.emplace_back("the MetaImage states no orientation: axes L P S assumed");
  const double scale = mm_per_unit(path, header);
  std::array<Vec3, 3> step;
  for (std::size_t a = 0; a < 3; ++a) {
    // The matrix holds directions; its columns are made unit vectors, so that only ElementSpacing decides the
    // size.
    const Vec3 direction{matrix[3 * a], matrix[3 * a + 1], matrix[3 * a + 2]};
    step[a] = normalized(direction) * (spacing[a] * scale);
  }
  return frame_from_steps(path, checked_dims(path, {dims[0], dims[1], dims[2]}), step,
                          Vec3{origin[0], origin[1], origin[2]} * scale);
}

void check_kind(const std::filesystem::path& path, const Header& header) {
  const std::string object = lower_case(value_of(header, {"objecttype"}).value_or("image"));
  if (object != "image") refuse_file(path, "image.header", fmt::format("holds a '{}', not an image", object));
  const std::string axes = value_of(header, {"ndims"}).value_or("3");
  if (axes != "3")
    refuse_file(path, "image.dims", fmt::format("has {} axes (NDims); a volume of three is needed", axes));
  if (value_of(header, {"elementnumberofchannels"}).value_or("1") != "1") {
    refuse_file(path, "image.type", "holds several channels a voxel; grey values are needed");
  }
  if (!is_true(header, {"binarydata"}) && value_of(header, {"binarydata"})) {
    refuse_file(path, "image.type", "holds its voxels as text, which is not read",
                "write it with BinaryData = True");
  }
}

// Where the voxels are, once frame and type are known.
void set_place(const std::filesystem::path& path, const Header& header, ImageLayout& layout) {
  const std::string data = header.fields.at("elementdatafile");
  const std::string word = lower_case(data);
  if (word.starts_with("list") || data.find('%') != std::string::npos ||
      data.find(' ') != std::string::npos) {
    refuse_file(path, "image.header",
                fmt::format("spreads its voxels over several files ('{}'), which is not read", data),
                "write it as one file");
  }
  const bool is_local = word == "local";
  layout.data_file = is_local ? path : data_file_beside(path, data);
  layout.file_offset = is_local ? header.bytes : 0;
  layout.coding = is_true(header, {"compresseddata"}) ? Coding::kDeflated : Coding::kPlain;
  const auto skip = integers_in(path, "HeaderSize", value_of(header, {"headersize"}).value_or("0"), 1)[0];
  if (skip > 0) layout.file_offset = static_cast<std::uint64_t>(skip);
  if (skip == -1 && layout.coding == Coding::kPlain) {  // the voxels are the last bytes of the file
    const std::uint64_t wanted = layout.frame.voxel_count() * bytes_of(layout.type);
    const std::uint64_t whole = std::filesystem::file_size(layout.data_file);
    layout.file_offset = whole > wanted ? whole - wanted : 0;
  }
}

}  // namespace

ImageLayout metaimage_layout(const std::filesystem::path& path) {
  const Header header = read_header(path);
  check_kind(path, header);
  ImageLayout layout;
  layout.format = "MetaImage";
  layout.frame = frame_of(path, header, layout.notes);
  layout.type = type_of(path, need(path, header, "ElementType"));
  layout.is_big_endian = is_true(header, {"binarydatabyteordermsb", "elementbyteordermsb"});
  layout.slope = numbers_in(path, "ElementToIntensityFunctionSlope",
                            value_of(header, {"elementtointensityfunctionslope"}).value_or("1"), 1)[0];
  layout.intercept = numbers_in(path, "ElementToIntensityFunctionOffset",
                                value_of(header, {"elementtointensityfunctionoffset"}).value_or("0"), 1)[0];
  set_place(path, header, layout);
  return layout;
}

}  // namespace periost
