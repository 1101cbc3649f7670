#include "pipeline/io/surface_read.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <numeric>
#include <system_error>
#include <tuple>

#include "pipeline/base/error.h"
#include "pipeline/base/file.h"
#include "pipeline/io/mesh_builder.h"
#include "pipeline/io/ply_read.h"
#include "pipeline/io/text_header.h"
#include "pipeline/io/text_scanner.h"
#include "pipeline/io/vtk_mesh_read.h"

namespace periost {
namespace {

using Path = std::filesystem::path;

[[noreturn]] void fail(const char* code, const Path& path, const std::string& text) {
  refuse_mesh(code, fmt::format("'{}'", path.string()), text);
}

[[noreturn]] void fail_line(const char* code, const Path& path, int line, const std::string& what) {
  refuse_mesh(code, fmt::format("{}:{}", path.string(), line), what);
}

[[noreturn]] void fail_line(const Path& path, int line, const std::string& what) {
  fail_line("surface.malformed", path, line, what);
}

Vec3 read_vertex(TextScanner& scanner, const Path& path) {
  Vec3 v;
  if (!scanner.number(v.x) || !scanner.number(v.y) || !scanner.number(v.z)) {
    fail_line(path, scanner.line(), "a vertex is not three numbers");
  }
  if (!is_finite(v)) {
    fail_line("surface.not_finite", path, scanner.line(), "a vertex has a coordinate that is not finite");
  }
  return v;
}

SurfaceMesh read_binary_stl(const Path& path, const std::string& bytes) {
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, sizeof count);
  if (bytes.size() < 84 + std::uint64_t{50} * count) {
    fail("surface.truncated", path,
         fmt::format("it ends in triangle {} of the {} that it announces", (bytes.size() - 84) / 50, count));
  }
  SurfaceMesh mesh;
  mesh.points.reserve(std::size_t{3} * count);
  for (std::uint32_t t = 0; t < count; ++t) {
    std::array<float, 12> values;
    std::memcpy(values.data(), bytes.data() + 84 + std::size_t{50} * t, sizeof values);
    for (std::size_t k = 3; k < 12; k += 3) {
      mesh.points.push_back({static_cast<double>(values[k]), static_cast<double>(values[k + 1]),
                             static_cast<double>(values[k + 2])});
    }
    mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  return mesh;
}

SurfaceMesh read_ascii_stl(const Path& path, const std::string& text) {
  SurfaceMesh mesh;
  TextScanner scanner(text);
  bool has_end = false;
  for (std::string_view word = scanner.word(); !word.empty(); word = scanner.word()) {
    has_end = has_end || word == "endsolid";
    if (word == "solid" || word == "endsolid") scanner.skip_line();
    if (word != "vertex") continue;
    mesh.points.push_back(read_vertex(scanner, path));
  }
  if (!has_end || mesh.points.size() % 3 != 0) {
    fail("surface.truncated", path,
         fmt::format("it ends within a facet or without 'endsolid', at line {}", scanner.line()));
  }
  for (Index p = 0; p < mesh.points.size(); p += 3) mesh.triangles.push_back({p, p + 1, p + 2});
  return mesh;
}

SurfaceMesh read_stl(const Path& path) {
  const std::string bytes = read_text(path);
  std::uint32_t count = 0;
  if (bytes.size() >= 84) std::memcpy(&count, bytes.data() + 80, sizeof count);
  const bool has_exact_size = bytes.size() >= 84 && bytes.size() == 84 + std::uint64_t{50} * count;
  if (!has_exact_size && bytes.compare(0, 5, "solid") == 0) return read_ascii_stl(path, bytes);
  if (bytes.size() < 84) fail("surface.truncated", path, "it is too short for an STL file");
  return read_binary_stl(path, bytes);
}

void add_polygon(SurfaceMesh& mesh, const std::vector<Index>& corners) {
  for (std::size_t k = 2; k < corners.size(); ++k) {
    mesh.triangles.push_back({corners[0], corners[k - 1], corners[k]});
  }
}

SurfaceMesh read_obj(const Path& path) {
  const std::string text = read_text(path);
  SurfaceMesh mesh;
  TextScanner scanner(text);
  scanner.set_comment('#');
  for (std::string_view word = scanner.word(); !word.empty(); word = scanner.word()) {
    if (word == "v") {
      mesh.points.push_back(read_vertex(scanner, path));
    } else if (word == "f") {
      std::vector<Index> corners;
      for (std::string_view c = scanner.word_in_line(); !c.empty(); c = scanner.word_in_line()) {
        c = c.substr(0, c.find('/'));
        long long id = 0;
        const auto [end, error] = std::from_chars(c.data(), c.data() + c.size(), id);
        if (error != std::errc() || end != c.data() + c.size())
          fail_line(path, scanner.line(), "a corner is not a number");
        if (id < 0) id += static_cast<long long>(mesh.points.size()) + 1;
        if (id < 1 || id > static_cast<long long>(kNoIndex)) {
          fail_line("surface.bad_index", path, scanner.line(), "a face names a vertex that does not exist");
        }
        corners.push_back(static_cast<Index>(id - 1));
      }
      if (corners.size() < 3) fail_line(path, scanner.line(), "a face has fewer than three corners");
      add_polygon(mesh, corners);
    }
    scanner.skip_line();
  }
  return mesh;
}

SurfaceMesh read_off(const Path& path) {
  const std::string text = read_text(path);
  SurfaceMesh mesh;
  TextScanner scanner(text);
  scanner.set_comment('#');
  if (scanner.word() != "OFF") fail("surface.malformed", path, "it does not start with 'OFF'");
  std::uint64_t points = 0, faces = 0, edges = 0;
  if (!scanner.number(points) || !scanner.number(faces) || !scanner.number(edges)) {
    fail_line(path, scanner.line(), "the counts of vertices, faces and edges are missing");
  }
  if (points > text.size() / 6 || faces > text.size() / 6) {
    fail("surface.truncated", path, "it is too short for the vertices and faces that it announces");
  }
  for (std::uint64_t p = 0; p < points; ++p) {
    mesh.points.push_back(read_vertex(scanner, path));
    scanner.skip_line();
  }
  for (std::uint64_t f = 0; f < faces; ++f) {
    std::uint32_t count = 0;
    if (!scanner.number(count) || count < 3 || count > text.size()) {
      fail_line(path, scanner.line(), "a face has fewer than three corners");
    }
    std::vector<Index> corners;
    for (std::uint32_t k = 0; k < count; ++k) {
      Index corner = 0;
      if (!scanner.number(corner)) fail_line(path, scanner.line(), "a corner is not a vertex number");
      if (corner >= points) {
        fail_line("surface.bad_index", path, scanner.line(),
                  fmt::format("a face names vertex {} of {}", corner, points));
      }
      corners.push_back(corner);
    }
    add_polygon(mesh, corners);
    scanner.skip_line();
  }
  return mesh;
}

void check(const Path& path, const SurfaceMesh& mesh) {
  for (std::size_t p = 0; p < mesh.points.size(); ++p) {
    if (!is_finite(mesh.points[p])) {
      fail("surface.not_finite", path, fmt::format("point {} has a coordinate that is not finite", p));
    }
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const Index corner : mesh.triangles[t]) {
      if (corner >= mesh.points.size()) {
        fail("surface.bad_index", path,
             fmt::format("triangle {} names point {} of {}", t, corner, mesh.points.size()));
      }
    }
  }
  if (mesh.triangles.empty()) fail("surface.empty", path, "it holds no triangles");
}

struct ReaderRow {
  const char* extension;
  SurfaceMesh (*read)(const Path&);
};
constexpr std::array<ReaderRow, 6> kReaders{{{".stl", read_stl},
                                             {".ply", read_ply},
                                             {".obj", read_obj},
                                             {".off", read_off},
                                             {".vtp", read_vtk_surface},
                                             {".vtk", read_vtk_surface}}};

std::string lower_extension(const Path& path) {
  return lower_case(path.extension().string());
}

const ReaderRow& reader_of(const Path& path) {
  const std::string extension = lower_extension(path);
  const auto row = std::find_if(kReaders.begin(), kReaders.end(),
                                [&](const ReaderRow& r) { return extension == r.extension; });
  if (row == kReaders.end()) {
    throw Error(ErrorKind::kInput, "surface.unknown_format",
                fmt::format("'{}' is not of a surface format that can be read", path.string()),
                "use .stl, .ply, .obj, .off, .vtp or .vtk");
  }
  return *row;
}

}  // namespace

void merge_equal_points(SurfaceMesh& mesh) {
  std::vector<Index> order(mesh.points.size());
  std::iota(order.begin(), order.end(), Index{0});
  const auto key = [&](Index p) { return std::tie(mesh.points[p].x, mesh.points[p].y, mesh.points[p].z); };
  std::sort(order.begin(), order.end(),
            [&](Index a, Index b) { return key(a) != key(b) ? key(a) < key(b) : a < b; });
  std::vector<Index> first(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    first[order[i]] = i > 0 && key(order[i]) == key(order[i - 1]) ? first[order[i - 1]] : order[i];
  }
  std::vector<Index> renumbered(order.size());
  Index kept = 0;
  for (Index p = 0; p < first.size(); ++p) {
    if (first[p] != p) {
      renumbered[p] = renumbered[first[p]];
      continue;
    }
    mesh.points[kept] = mesh.points[p];
    for (auto& field : mesh.point_fields) field.second[kept] = field.second[p];
    renumbered[p] = kept++;
  }
  mesh.points.resize(kept);
  for (auto& field : mesh.point_fields) field.second.resize(kept);
  for (Triangle& t : mesh.triangles) {
    for (Index& corner : t) corner = renumbered[corner];
  }
}

void check_surface_file(const Path& path) {
  reader_of(path);
  std::error_code unknown;
  if (std::filesystem::exists(path, unknown) && !std::filesystem::is_directory(path, unknown)) return;
  throw Error(ErrorKind::kInput, "surface.missing", fmt::format("there is no file '{}'", path.string()),
              "check the path; in a configuration, a relative one starts at the configuration's folder");
}

bool is_stl_file(const Path& path) {
  return lower_extension(path) == ".stl";
}

SurfaceMesh read_surface(const Path& path) {
  check_surface_file(path);
  SurfaceMesh mesh = reader_of(path).read(path);
  check(path, mesh);
  merge_equal_points(mesh);
  mesh.was_read = true;
  return mesh;
}

}  // namespace periost
