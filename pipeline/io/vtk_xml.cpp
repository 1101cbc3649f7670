#include "pipeline/io/vtk_xml.h"

#include <fmt/format.h>

#include <bit>

#include "pipeline/base/file.h"

namespace periost {
namespace {

static_assert(std::endian::native == std::endian::little, "the files are little-endian");

template <class T>
VtkXmlArray array_over(std::string name, const char* type, const std::vector<T>& values, int components) {
  return {std::move(name),
          type,
          components,
          values.data(),
          values.size() / static_cast<std::size_t>(components),
          values.size() * sizeof(T)};
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

// Appends the descriptions of arrays to the header; `offset` runs along the appended bytes.
void describe(const std::vector<VtkXmlArray>& arrays, bool with_tuples, std::size_t& offset,
              std::string& header) {
  for (const VtkXmlArray& array : arrays) {
    header += fmt::format(R"(<DataArray type="{}" Name="{}")", array.type, escaped(array.name));
    if (array.components > 1) header += fmt::format(R"( NumberOfComponents="{}")", array.components);
    if (with_tuples) header += fmt::format(R"( NumberOfTuples="{}")", array.tuples);
    header += fmt::format(R"( format="appended" offset="{}"/>)", offset) + "\n";
    offset += sizeof(std::uint64_t) + array.bytes;
  }
}

void append(const std::vector<VtkXmlArray>& arrays, AtomicFile& file) {
  for (const VtkXmlArray& array : arrays) {
    const std::uint64_t bytes = array.bytes;
    file.write(&bytes, sizeof bytes);
    if (bytes > 0) file.write(array.data, bytes);
  }
}

}  // namespace

void write_vtk_xml(const std::filesystem::path& path, const char* kind, const std::string& piece_attributes,
                   const std::vector<VtkXmlArray>& field_data, const std::vector<VtkXmlSection>& sections) {
  std::size_t offset = 0;
  std::string header = fmt::format(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"{0}\" version=\"1.0\" byte_order=\"LittleEndian\" "
      "header_type=\"UInt64\">\n<{0}>\n",
      kind);
  header += "<FieldData>\n";
  describe(field_data, true, offset, header);
  header += fmt::format("</FieldData>\n<Piece {}>\n", piece_attributes);
  for (const VtkXmlSection& section : sections) {
    header += fmt::format("<{}>\n", section.tag);
    describe(section.arrays, false, offset, header);
    header += fmt::format("</{}>\n", section.tag);
  }
  header += fmt::format("</Piece>\n</{}>\n<AppendedData encoding=\"raw\">\n_", kind);

  AtomicFile file(path);
  file.write(header);
  append(field_data, file);
  for (const VtkXmlSection& section : sections) append(section.arrays, file);
  file.write("\n</AppendedData>\n</VTKFile>\n");
  file.commit();
}

VtkXmlArray vtk_array(std::string name, const std::vector<Vec3>& points) {
  static_assert(sizeof(Vec3) == 3 * sizeof(double));
  return {std::move(name), "Float64", 3, points.data(), points.size(), points.size() * sizeof(Vec3)};
}
VtkXmlArray vtk_array(std::string name, const std::vector<float>& values) {
  return array_over(std::move(name), "Float32", values, 1);
}
VtkXmlArray vtk_array(std::string name, const std::vector<double>& values) {
  return array_over(std::move(name), "Float64", values, 1);
}
VtkXmlArray vtk_array(std::string name, const std::vector<std::int32_t>& values) {
  return array_over(std::move(name), "Int32", values, 1);
}
VtkXmlArray vtk_array(std::string name, const std::vector<std::int64_t>& values, int components) {
  return array_over(std::move(name), "Int64", values, components);
}
VtkXmlArray vtk_array(std::string name, const std::vector<std::uint8_t>& values) {
  return array_over(std::move(name), "UInt8", values, 1);
}

std::vector<VtkXmlArray> vtk_arrays(const Fields& fields) {
  std::vector<VtkXmlArray> arrays;
  for (const auto& [name, values] : fields) arrays.push_back(vtk_array(name, values));
  return arrays;
}

std::vector<std::int64_t> vtk_offsets(std::size_t count, std::int64_t size) {
  std::vector<std::int64_t> offsets(count);
  for (std::size_t i = 0; i < count; ++i) offsets[i] = static_cast<std::int64_t>(i + 1) * size;
  return offsets;
}

}  // namespace periost
