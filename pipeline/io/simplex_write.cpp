#include "pipeline/io/simplex_write.h"

#include <fmt/format.h>

#include <algorithm>

#include "pipeline/io/vtk_xml.h"

namespace periost {
namespace {

// The vertices around a face, counter-clockwise, or nothing when the walk meets a border. Around a face the
// next vertex is the neighbour across from the face's follower, as around a corner of the dual triangulation.
std::vector<std::int64_t> polygon(const SimplexMesh& mesh, SimplexFace face) {
  std::vector<std::int64_t> corners;
  const SimplexVertex first = mesh.first_vertex[index_of(face)];
  SimplexVertex vertex = first;
  do {
    if (vertex == kNoVertex || corners.size() > mesh.valence[index_of(face)]) return {};
    corners.push_back(index_of(vertex));
    const auto& faces = mesh.face[index_of(vertex)];
    const auto at = static_cast<std::size_t>(std::find(faces.begin(), faces.end(), face) - faces.begin());
    if (at == faces.size()) return {};
    vertex = mesh.neighbour[index_of(vertex)][(at + 1) % 3];
  } while (vertex != first);
  return corners;
}

}  // namespace

void write_simplex_vtp(const SimplexMesh& mesh, const std::filesystem::path& path) {
  std::vector<std::int64_t> corners, offsets;
  Fields fields;
  for (std::size_t f = 0; f < mesh.first_vertex.size(); ++f) {
    const std::vector<std::int64_t> face = polygon(mesh, face_at(f));
    if (face.empty()) continue;
    corners.insert(corners.end(), face.begin(), face.end());
    offsets.push_back(static_cast<std::int64_t>(corners.size()));
    for (const auto& [name, values] : mesh.face_fields) fields[name].push_back(values[f]);
  }
  write_vtk_xml(
      path, "PolyData",
      fmt::format(
          R"(NumberOfPoints="{}" NumberOfVerts="0" NumberOfLines="0" NumberOfStrips="0" NumberOfPolys="{}")",
          mesh.position.size(), offsets.size()),
      {},
      {{"CellData", vtk_arrays(fields)},
       {"Points", {vtk_array("Points", mesh.position)}},
       {"Polys", {vtk_array("connectivity", corners), vtk_array("offsets", offsets)}}});
}

}  // namespace periost
