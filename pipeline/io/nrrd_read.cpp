// NRRD (.nrrd, .nhdr): https://teem.sourceforge.net/nrrd/format.html.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "pipeline/io/image_layout.h"
#include "pipeline/io/text_header.h"

namespace periost {
namespace {

struct TypeRow {
  std::string_view names;  // each between bars
  VoxelType type;
};
constexpr std::array<TypeRow, 10> kTypes{
    {{"|signed char|int8|int8_t|", VoxelType::kInt8},
     {"|uchar|unsigned char|uint8|uint8_t|", VoxelType::kUint8},
     {"|short|short int|signed short|signed short int|int16|int16_t|", VoxelType::kInt16},
     {"|ushort|unsigned short|unsigned short int|uint16|uint16_t|", VoxelType::kUint16},
     {"|int|signed int|int32|int32_t|", VoxelType::kInt32},
     {"|uint|unsigned int|uint32|uint32_t|", VoxelType::kUint32},
     {"|longlong|long long|long long int|signed long long|signed long long int|int64|int64_t|",
      VoxelType::kInt64},
     {"|ulonglong|unsigned long long|unsigned long long int|uint64|uint64_t|", VoxelType::kUint64},
     {"|float|", VoxelType::kFloat32},
     {"|double|", VoxelType::kFloat64}}};

struct SpaceRow {
  std::string_view names;
  Vec3 to_lps;         // sign of each coordinate
  bool is_anatomical;  // else the coordinates are taken as LPS, with a note
};
constexpr std::array<SpaceRow, 6> kSpaces{{{"|left-posterior-superior|lps|", {1, 1, 1}, true},
                                           {"|right-anterior-superior|ras|", {-1, -1, 1}, true},
                                           {"|left-anterior-superior|las|", {1, -1, 1}, true},
                                           {"|scanner-xyz|", {1, 1, 1}, false},
                                           {"|3d-right-handed|", {1, 1, 1}, false},
                                           {"|3d-left-handed|", {1, 1, 1}, false}}};

struct UnitRow {
  std::string_view name;
  double mm;
};
constexpr std::array<UnitRow, 10> kUnits{{{"mm", 1},
                                          {"millimeter", 1},
                                          {"millimeters", 1},
                                          {"millimetre", 1},
                                          {"cm", 10},
                                          {"um", 0.001},
                                          {"micron", 0.001},
                                          {"microns", 0.001},
                                          {"m", 1000},
                                          {"", 1}}};

bool is_one_of(std::string_view names, std::string_view name) {
  return names.find(fmt::format("|{}|", name)) != std::string_view::npos;
}

struct Header {
  std::map<std::string, std::string, std::less<>> fields;  // by lower-case name without blanks
  std::size_t bytes = 0;                                   // up to and with the blank line
  bool has_blank_line = false;

  std::optional<std::string> find(std::string_view name) const {
    const auto found = fields.find(name);
    return found == fields.end() ? std::nullopt : std::optional(found->second);
  }
};

std::string field_name(std::string_view text) {
  std::string name = lower_case(trimmed(text));
  std::erase(name, ' ');
  return name;
}

void add_field(const std::filesystem::path& path, std::string_view line, Header& header) {
  if (line.starts_with('#')) return;
  const std::size_t colon = line.find(':');
  if (colon == std::string_view::npos) {
    refuse_file(path, "image.header",
                fmt::format("has a line without a colon in its header: '{}'", line.substr(0, 60)));
  }
  if (line.substr(colon).starts_with(":=")) return;  // a key and value of the user's own
  header.fields.insert_or_assign(field_name(line.substr(0, colon)),
                                 std::string(trimmed(line.substr(colon + 1))));
}

Header read_header(const std::filesystem::path& path) {
  const std::string head = read_head(path);
  Header header;
  std::string_view line;
  if (!next_line(head, header.bytes, line) || line.size() != 8 || !line.starts_with("NRRD000")) {
    refuse_file(path, "image.header", "is not a NRRD file: it does not begin with 'NRRD000'");
  }
  while (next_line(head, header.bytes, line)) {
    if (line.empty()) {
      header.has_blank_line = true;
      return header;
    }
    add_field(path, line, header);
  }
  if (header.bytes < head.size())
    add_field(path, trimmed(std::string_view(head).substr(header.bytes)), header);
  return header;
}

std::string need(const std::filesystem::path& path, const Header& header, std::string_view name) {
  const auto value = header.find(name);
  if (!value) refuse_file(path, "image.header", fmt::format("lacks '{}' in its header", name));
  return *value;
}

VoxelType type_of(const std::filesystem::path& path, const std::string& name) {
  for (const TypeRow& row : kTypes) {
    if (is_one_of(row.names, name)) return row.type;
  }
  refuse_file(path, "image.type", fmt::format("has voxels of type '{}', which is not read", name));
}

// The words in quotes of a value such as "mm" "mm" "mm"; all must name one unit.
double mm_per_unit(const std::filesystem::path& path, std::string value) {
  std::replace(value.begin(), value.end(), '"', ' ');
  const std::string_view all = trimmed(value);
  const std::string first = lower_case(all.substr(0, all.find(' ')));
  for (std::size_t at = 0; (at = all.find_first_not_of(' ', at)) != std::string_view::npos;) {
    const std::string_view word = all.substr(at, all.find(' ', at) - at);
    if (lower_case(word) != first)
      refuse_file(path, "image.header", "has different units of length along its axes");
    at += word.size();
  }
  for (const UnitRow& row : kUnits) {
    if (row.name == first) return row.mm;
  }
  refuse_file(path, "image.header", fmt::format("has an unknown unit of length '{}'", first));
}

// Axes along which several values form one voxel or one moment cannot be read; the kinds say so.
void check_kinds(const std::filesystem::path& path, const Header& header) {
  const auto dimension = need(path, header, "dimension");
  if (dimension != "3") {
    refuse_file(path, "image.dims", fmt::format("has {} axes; a volume of three is needed", dimension),
                "split it first and give one volume of grey values");
  }
  const std::string kinds = lower_case(header.find("kinds").value_or(""));
  for (std::size_t at = 0; (at = kinds.find_first_not_of(' ', at)) != std::string::npos;) {
    const std::string kind = kinds.substr(at, kinds.find(' ', at) - at);
    at += kind.size();
    if (kind == "domain" || kind == "space" || kind == "???" || kind == "none") continue;
    refuse_file(path, "image.dims",
                fmt::format("has an axis of kind '{}'; three axes in space are needed", kind));
  }
}

std::array<Vec3, 3> steps_of(const std::filesystem::path& path, const Header& header) {
  std::array<Vec3, 3> step{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  if (const auto directions = header.find("spacedirections")) {
    if (lower_case(*directions).find("none") != std::string::npos) {
      refuse_file(path, "image.dims",
                  "has an axis without direction in space; three axes in space are needed");
    }
    const auto numbers = numbers_in(path, "space directions", *directions, 9);
    for (std::size_t a = 0; a < 3; ++a) step[a] = {numbers[3 * a], numbers[3 * a + 1], numbers[3 * a + 2]};
  } else if (const auto spacings = header.find("spacings")) {
    const auto numbers = numbers_in(path, "spacings", *spacings, 3);
    for (std::size_t a = 0; a < 3; ++a) step[a] = step[a] * numbers[a];
  }
  return step;
}

// The signs that turn the file's space into LPS.
Vec3 signs_of(const std::filesystem::path& path, const Header& header, std::vector<std::string>& notes) {
  const auto space = header.find("space");
  if (!space) {
    notes.emplace_back("the NRRD file names no space: its coordinates are taken as LPS");
    return {1, 1, 1};
  }
  for (const SpaceRow& row : kSpaces) {
    if (!is_one_of(row.names, lower_case(*space))) continue;
    if (!row.is_anatomical) {
      notes.emplace_back(
          fmt::format("the NRRD file's space is '{}': its coordinates are taken as LPS", *space));
    }
    return row.to_lps;
  }
  refuse_file(
      path, "image.frame", fmt::format("lies in the space '{}', which is not read", *space),
      "spaces are left-posterior-superior, right-anterior-superior, left-anterior-superior, scanner-xyz");
}

GridFrame frame_of(const std::filesystem::path& path, const Header& header, std::vector<std::string>& notes) {
  const auto sizes = integers_in(path, "sizes", need(path, header, "sizes"), 3);
  if (header.find("spacedimension").value_or("3") != "3") {
    refuse_file(path, "image.frame", "does not lie in a space of three dimensions");
  }
  std::array<Vec3, 3> step = steps_of(path, header);
  const auto origin = numbers_in(path, "space origin", header.find("spaceorigin").value_or("(0,0,0)"), 3);
  const double scale =
      mm_per_unit(path, header.find("spaceunits").value_or(header.find("units").value_or("mm")));
  const Vec3 sign = signs_of(path, header, notes) * scale;
  const auto to_lps = [&](Vec3 v) { return Vec3{v.x * sign.x, v.y * sign.y, v.z * sign.z}; };
  for (Vec3& s : step) s = to_lps(s);
  return frame_from_steps(path, checked_dims(path, {sizes[0], sizes[1], sizes[2]}), step,
                          to_lps({origin[0], origin[1], origin[2]}));
}

// The byte behind `lines` line feeds, counted from `offset`.
std::uint64_t skip_lines(const std::filesystem::path& path, std::uint64_t offset, std::int64_t lines) {
  if (lines <= 0) return offset;
  ByteSource source(path, Coding::kPlain, offset);
  std::array<char, 4096> buffer{};
  for (std::size_t got = 0; (got = source.read(buffer.data(), buffer.size())) > 0; offset += got) {
    for (std::size_t n = 0; n < got; ++n) {
      if (buffer[n] == '\n' && --lines == 0) return offset + n + 1;
    }
  }
  refuse_file(path, "image.truncated", "has fewer lines than 'line skip' of the NRRD header says");
}

void set_place(const std::filesystem::path& path, const Header& header, ImageLayout& layout) {
  const std::string encoding = lower_case(need(path, header, "encoding"));
  if (encoding != "raw" && encoding != "gzip" && encoding != "gz") {
    refuse_file(path, "image.type", fmt::format("has the encoding '{}', which is not read", encoding),
                "write it with encoding raw or gzip");
  }
  layout.coding = encoding == "raw" ? Coding::kPlain : Coding::kDeflated;
  const auto data = header.find("datafile");
  if (!data && !header.has_blank_line) {
    refuse_file(path, "image.truncated",
                "ends within its header: no blank line comes before the voxels, and no data file is named");
  }
  if (data && (data->starts_with("LIST") || data->find('%') != std::string::npos)) {
    refuse_file(path, "image.header",
                fmt::format("spreads its voxels over several files ('{}'), which is not read", *data),
                "write it as one file");
  }
  layout.data_file = data ? data_file_beside(path, *data) : path;
  const auto lines = integers_in(path, "line skip", header.find("lineskip").value_or("0"), 1)[0];
  layout.file_offset = skip_lines(layout.data_file, data ? 0 : header.bytes, lines);
  const auto skip = integers_in(path, "byte skip", header.find("byteskip").value_or("0"), 1)[0];
  if (skip < -1 || (skip == -1 && encoding != "raw")) {
    refuse_file(path, "image.header", fmt::format("has a 'byte skip' of {}, which cannot be", skip));
  }
  if (skip == -1) {  // the voxels are the last bytes of the file
    const std::uint64_t wanted = layout.frame.voxel_count() * bytes_of(layout.type);
    const std::uint64_t whole = std::filesystem::file_size(layout.data_file);
    layout.file_offset = std::max(layout.file_offset, whole > wanted ? whole - wanted : 0);
  } else {
    layout.decoded_offset = static_cast<std::uint64_t>(skip);
  }
}

bool is_big_endian(const std::filesystem::path& path, const Header& header, VoxelType type) {
  if (bytes_of(type) == 1) return false;
  const std::string endian = lower_case(need(path, header, "endian"));
  if (endian == "big") return true;
  if (endian == "little") return false;
  refuse_file(path, "image.header", fmt::format("has the endian '{}'; it can be little or big", endian));
}

}  // namespace

ImageLayout nrrd_layout(const std::filesystem::path& path) {
  const Header header = read_header(path);
  check_kinds(path, header);
  ImageLayout layout;
  layout.format = "NRRD";
  layout.frame = frame_of(path, header, layout.notes);
  layout.type = type_of(path, lower_case(need(path, header, "type")));
  layout.is_big_endian = is_big_endian(path, header, layout.type);
  set_place(path, header, layout);
  return layout;
}

}  // namespace periost
