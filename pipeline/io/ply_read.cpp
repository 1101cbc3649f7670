#include "pipeline/io/ply_read.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "pipeline/base/file.h"
#include "pipeline/io/mesh_builder.h"
#include "pipeline/io/text_scanner.h"

namespace periost {
namespace {

using Path = std::filesystem::path;

struct NumberType {
  const char* names[2];
  std::size_t bytes;
  double (*decode)(const char*);
};

template <class T>
double decode_as(const char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return static_cast<double>(value);
}

constexpr std::array<NumberType, 8> kTypes{{{{"char", "int8"}, 1, decode_as<std::int8_t>},
                                            {{"uchar", "uint8"}, 1, decode_as<std::uint8_t>},
                                            {{"short", "int16"}, 2, decode_as<std::int16_t>},
                                            {{"ushort", "uint16"}, 2, decode_as<std::uint16_t>},
                                            {{"int", "int32"}, 4, decode_as<std::int32_t>},
                                            {{"uint", "uint32"}, 4, decode_as<std::uint32_t>},
                                            {{"float", "float32"}, 4, decode_as<float>},
                                            {{"double", "float64"}, 8, decode_as<double>}}};

struct Property {
  std::string name;
  const NumberType* type = nullptr;
  const NumberType* count_type = nullptr;  // lists only
};
struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

class PlyReader {
 public:
  explicit PlyReader(const Path& path) : path_(path), text_(read_text(path)), scanner_(text_) {}

  SurfaceMesh read() {
    read_header();
    SurfaceMesh mesh;
    for (const Element& element : elements_) {
      // Every record takes at least one byte.
      if (element.count > bytes_left()) {
        fail("surface.truncated", fmt::format("it is too short for {} of '{}'", element.count, element.name));
      }
      for (std::uint64_t i = 0; i < element.count; ++i) read_record(element, i, mesh);
    }
    // A header that names an element or a property twice leaves fields of a wrong length.
    std::erase_if(mesh.point_fields, [&](const auto& f) { return f.second.size() != mesh.points.size(); });
    std::erase_if(mesh.triangle_fields,
                  [&](const auto& f) { return f.second.size() != mesh.triangles.size(); });
    return mesh;
  }

 private:
  [[noreturn]] void fail(const char* code, const std::string& what) const {
    refuse_mesh(code, fmt::format("'{}'", path_.string()), what);
  }
  const NumberType* type_of(std::string_view name) const {
    for (const NumberType& type : kTypes) {
      if (name == type.names[0] || name == type.names[1]) return &type;
    }
    fail("surface.malformed", fmt::format("unknown type '{}' in the header", name));
  }

  void read_header() {
    const std::size_t end = text_.find("end_header");
    const std::size_t line_end = end == std::string::npos ? end : text_.find('\n', end);
    if (text_.compare(0, 3, "ply") != 0 || line_end == std::string::npos) {
      fail("surface.malformed", "it has no PLY header");
    }
    TextScanner header(std::string_view(text_).substr(0, end));
    header.word();
    for (std::string_view word = header.word(); !word.empty(); word = header.word()) {
      if (word == "format") {
        const std::string_view format = header.word();
        is_text_ = format == "ascii";
        is_swapped_ = format == "binary_big_endian";
        if (!is_text_ && !is_swapped_ && format != "binary_little_endian") {
          fail("surface.malformed", fmt::format("unknown format '{}'", format));
        }
      } else if (word == "element") {
        Element& element = elements_.emplace_back();
        element.name = header.word();
        if (!header.number(element.count)) fail("surface.malformed", "an element has no count");
      } else if (word == "property") {
        if (elements_.empty()) fail("surface.malformed", "a property stands before its element");
        Property property;
        std::string_view type = header.word();
        if (type == "list") {
          property.count_type = type_of(header.word());
          type = header.word();
        }
        property.type = type_of(type);
        property.name = header.word();
        elements_.back().properties.push_back(property);
      }
      header.skip_line();
    }
    position_ = line_end + 1;
    scanner_ = TextScanner(std::string_view(text_).substr(position_));
  }

  std::size_t bytes_left() const { return is_text_ ? scanner_.bytes_left() : text_.size() - position_; }

  double number(const NumberType& type, const Element& element, std::uint64_t i) {
    double value = 0;
    if (is_text_) {
      if (!scanner_.number(value)) {
        fail(scanner_.at_end() ? "surface.truncated" : "surface.malformed",
             fmt::format("{} {} is incomplete", element.name, i));
      }
      return value;
    }
    if (type.bytes > text_.size() - position_) {
      fail("surface.truncated", fmt::format("it ends in {} {} of {}", element.name, i, element.count));
    }
    std::array<char, 8> bytes{};
    std::memcpy(bytes.data(), text_.data() + position_, type.bytes);
    if (is_swapped_) std::reverse(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(type.bytes));
    position_ += type.bytes;
    return type.decode(bytes.data());
  }

  void read_record(const Element& element, std::uint64_t i, SurfaceMesh& mesh) {
    const bool is_vertex = element.name == "vertex", is_face = element.name == "face";
    const std::size_t first_triangle = mesh.triangles.size();
    values_.clear();
    if (is_vertex) mesh.points.emplace_back();
    for (const Property& property : element.properties) {
      if (property.count_type != nullptr) {
        read_list(property, element, i);
        if (is_face && property.name.rfind("vertex_ind", 0) == 0) add_fan(mesh);
        continue;
      }
      const double value = number(*property.type, element, i);
      const std::size_t axis = property.name.size() == 1 ? std::string_view("xyz").find(property.name[0]) : 3;
      if (is_vertex && axis < 3) {
        mesh.points.back()[axis] = value;
      } else if (is_vertex) {
        mesh.point_fields[property.name].push_back(static_cast<float>(value));
      } else if (is_face) {
        values_.emplace_back(&property.name, static_cast<float>(value));
      }
    }
    // Values may stand before the corners, so how many triangles a face has is known at its end.
    const std::size_t triangles = mesh.triangles.size() - first_triangle;
    for (const auto& [name, value] : values_) {
      std::vector<float>& field = mesh.triangle_fields[*name];
      field.insert(field.end(), triangles, value);
    }
  }

  void read_list(const Property& property, const Element& element, std::uint64_t i) {
    const double count = number(*property.count_type, element, i);
    if (!(count >= 0) || count > static_cast<double>(bytes_left())) {
      fail("surface.truncated", fmt::format("the list of {} {} is longer than the file", element.name, i));
    }
    corners_.clear();
    for (auto left = static_cast<std::uint64_t>(count); left > 0; --left) {
      const double corner = number(*property.type, element, i);
      const bool is_index = corner >= 0 && corner < static_cast<double>(kNoIndex);
      corners_.push_back(is_index ? static_cast<Index>(corner) : kNoIndex);
    }
  }

  void add_fan(SurfaceMesh& mesh) const {
    for (std::size_t k = 2; k < corners_.size(); ++k) {
      mesh.triangles.push_back({corners_[0], corners_[k - 1], corners_[k]});
    }
  }

  const Path& path_;
  std::string text_;
  TextScanner scanner_;
  std::size_t position_ = 0;
  bool is_text_ = false, is_swapped_ = false;
  std::vector<Element> elements_;
  // Of the record being read: its list of corners, and a face's values by name.
  std::vector<Index> corners_;
  std::vector<std::pair<const std::string*, float>> values_;
};

}  // namespace

SurfaceMesh read_ply(const Path& path) {
  return PlyReader(path).read();
}

}  // namespace periost
