#include "pipeline/io/surface_write.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>
#include <iterator>

#include "pipeline/base/error.h"
#include "pipeline/base/file.h"
#include "pipeline/io/vtk_xml.h"

namespace periost {
namespace {

using Path = std::filesystem::path;

void append_floats(std::string& out, Vec3 v) {
  const std::array<float, 3> values{static_cast<float>(v.x), static_cast<float>(v.y),
                                    static_cast<float>(v.z)};
  out.append(reinterpret_cast<const char*>(values.data()), sizeof values);
}

template <class T>
void append_bytes(std::string& out, T value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

void write_stl(const SurfaceMesh& mesh, const Path& path) {
  AtomicFile file(path);
  std::string record(80, ' ');
  const std::string_view title = "binary STL, millimetres, LPS";
  std::copy(title.begin(), title.end(), record.begin());
  append_bytes(record, static_cast<std::uint32_t>(mesh.triangles.size()));
  file.write(record);
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3 p = mesh.points[a], q = mesh.points[b], r = mesh.points[c];
    record.clear();
    append_floats(record, normalized(cross(q - p, r - p)));
    for (const Vec3 corner : {p, q, r}) append_floats(record, corner);
    append_bytes(record, std::uint16_t{0});
    file.write(record);
  }
  file.commit();
}

// A property name of PLY: one word.
std::string word_of(std::string name) {
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return std::isspace(c) != 0; }, '_');
  return name;
}

std::string ply_header(const SurfaceMesh& mesh) {
  std::string header = "ply\nformat binary_little_endian 1.0\ncomment millimetres, LPS\n";
  header += fmt::format("element vertex {}\n", mesh.points.size());
  for (const char* axis : {"x", "y", "z"}) header += fmt::format("property double {}\n", axis);
  for (const auto& field : mesh.point_fields)
    header += fmt::format("property float {}\n", word_of(field.first));
  header += fmt::format("element face {}\nproperty list uchar int vertex_indices\n", mesh.triangles.size());
  for (const auto& field : mesh.triangle_fields) {
    header += fmt::format("property float {}\n", word_of(field.first));
  }
  return header + "end_header\n";
}

void write_ply(const SurfaceMesh& mesh, const Path& path) {
  AtomicFile file(path);
  file.write(ply_header(mesh));
  std::string record;
  for (std::size_t p = 0; p < mesh.points.size(); ++p) {
    record.clear();
    append_bytes(record, mesh.points[p]);
    for (const auto& field : mesh.point_fields) append_bytes(record, field.second[p]);
    file.write(record);
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    record.clear();
    append_bytes(record, std::uint8_t{3});
    for (const Index corner : mesh.triangles[t]) append_bytes(record, static_cast<std::int32_t>(corner));
    for (const auto& field : mesh.triangle_fields) append_bytes(record, field.second[t]);
    file.write(record);
  }
  file.commit();
}

void write_obj(const SurfaceMesh& mesh, const Path& path) {
  AtomicFile file(path);
  file.write("# millimetres, LPS\n");
  std::string line;
  for (const Vec3& p : mesh.points) {
    line.clear();
    fmt::format_to(std::back_inserter(line), "v {} {} {}\n", p.x, p.y, p.z);
    file.write(line);
  }
  for (const auto& [a, b, c] : mesh.triangles) {
    line.clear();
    fmt::format_to(std::back_inserter(line), "f {} {} {}\n", std::uint64_t{a} + 1, std::uint64_t{b} + 1,
                   std::uint64_t{c} + 1);
    file.write(line);
  }
  file.commit();
}

void write_off(const SurfaceMesh& mesh, const Path& path) {
  AtomicFile file(path);
  file.write(fmt::format("OFF\n{} {} 0\n", mesh.points.size(), mesh.triangles.size()));
  std::string line;
  for (const Vec3& p : mesh.points) {
    line.clear();
    fmt::format_to(std::back_inserter(line), "{} {} {}\n", p.x, p.y, p.z);
    file.write(line);
  }
  for (const auto& [a, b, c] : mesh.triangles) {
    line.clear();
    fmt::format_to(std::back_inserter(line), "3 {} {} {}\n", a, b, c);
    file.write(line);
  }
  file.commit();
}

void write_vtp(const SurfaceMesh& mesh, const Path& path) {
  std::vector<std::int64_t> corners;
  corners.reserve(3 * mesh.triangles.size());
  for (const Triangle& t : mesh.triangles) corners.insert(corners.end(), t.begin(), t.end());
  const std::vector<std::int64_t> offsets = vtk_offsets(mesh.triangles.size(), 3);
  const std::vector<double> voxel{mesh.voxel_mm};
  std::vector<VtkXmlArray> field_data;
  if (mesh.voxel_mm > 0) field_data.push_back(vtk_array("voxel_mm", voxel));
  write_vtk_xml(
      path, "PolyData",
      fmt::format(
          R"(NumberOfPoints="{}" NumberOfVerts="0" NumberOfLines="0" NumberOfStrips="0" NumberOfPolys="{}")",
          mesh.points.size(), mesh.triangles.size()),
      field_data,
      {{"PointData", vtk_arrays(mesh.point_fields)},
       {"CellData", vtk_arrays(mesh.triangle_fields)},
       {"Points", {vtk_array("Points", mesh.points)}},
       {"Polys", {vtk_array("connectivity", corners), vtk_array("offsets", offsets)}}});
}

struct FormatRow {
  SurfaceFormat format;
  void (*write)(const SurfaceMesh&, const Path&);
};
// In the order of surface_format_names().
constexpr std::array<FormatRow, 5> kFormats{{{SurfaceFormat::kStl, write_stl},
                                             {SurfaceFormat::kPly, write_ply},
                                             {SurfaceFormat::kObj, write_obj},
                                             {SurfaceFormat::kOff, write_off},
                                             {SurfaceFormat::kVtp, write_vtp}}};

}  // namespace

const std::vector<std::string>& surface_format_names() {
  static const std::vector<std::string> names{"stl", "ply", "obj", "off", "vtp"};
  return names;
}

std::optional<SurfaceFormat> surface_format_from_name(std::string_view name) {
  const auto& names = surface_format_names();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) return std::nullopt;
  return kFormats[static_cast<std::size_t>(found - names.begin())].format;
}

const std::string& name_of(SurfaceFormat format) {
  std::size_t row = 0;
  while (kFormats[row].format != format) ++row;
  return surface_format_names()[row];
}

void write_surface(const SurfaceMesh& mesh, const Path& path, SurfaceFormat format) {
  for (const FormatRow& row : kFormats) {
    if (row.format == format) row.write(mesh, path);
  }
}

void write_surface(const SurfaceMesh& mesh, const Path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const auto format = surface_format_from_name(extension.empty() ? "" : extension.substr(1));
  if (!format) {
    throw Error(ErrorKind::kUsage, "surface.unknown_format",
                fmt::format("'{}' does not end in the name of a surface format", path.string()),
                "use .stl, .ply, .obj, .off or .vtp");
  }
  write_surface(mesh, path, *format);
}

}  // namespace periost
