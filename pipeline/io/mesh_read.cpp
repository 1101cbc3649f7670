#include "pipeline/io/mesh_read.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <system_error>

#include "pipeline/base/error.h"
#include "pipeline/io/abaqus_deck.h"
#include "pipeline/io/gmsh_read.h"
#include "pipeline/io/surface_read.h"
#include "pipeline/io/tetgen_read.h"
#include "pipeline/io/text_header.h"
#include "pipeline/io/vtk_mesh_read.h"

namespace periost {
namespace {

using Path = std::filesystem::path;

AnyMesh read_any_surface(const Path& path) {
  return read_surface(path);
}

AnyMesh read_deck(const Path& path) {
  return read_abaqus(path).mesh;
}

struct ReaderRow {
  const char* extension;
  AnyMesh (*read)(const Path&);
};
constexpr std::array<ReaderRow, 11> kReaders{{{".stl", read_any_surface},
                                              {".ply", read_any_surface},
                                              {".obj", read_any_surface},
                                              {".off", read_any_surface},
                                              {".vtp", read_any_surface},
                                              {".vtk", read_vtk_mesh},
                                              {".vtu", read_vtk_mesh},
                                              {".msh", read_gmsh},
                                              {".inp", read_deck},
                                              {".ele", read_tetgen},
                                              {".node", read_tetgen}}};

}  // namespace

const std::string& mesh_extensions() {
  static const std::string kAll = [] {
    std::string all;
    for (const ReaderRow& row : kReaders) all += (all.empty() ? "" : " ") + std::string(row.extension);
    return all;
  }();
  return kAll;
}

AnyMesh read_mesh(const Path& path) {
  const std::string extension = lower_case(path.extension().string());
  const auto row = std::find_if(kReaders.begin(), kReaders.end(),
                                [&](const ReaderRow& r) { return extension == r.extension; });
  if (row == kReaders.end()) {
    refuse_mesh("mesh.unknown_format", path.string(), "it is not of a mesh format that can be read",
                "use one of " + mesh_extensions());
  }
  std::error_code unknown;
  if (row->read != read_any_surface && !std::filesystem::is_regular_file(path, unknown)) {
    refuse_mesh("mesh.missing", path.string(), "there is no such file", "check the path");
  }
  return row->read(path);
}

}  // namespace periost
