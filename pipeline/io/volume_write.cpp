#include "pipeline/io/volume_write.h"

#include <fmt/format.h>

#include "pipeline/io/vtk_xml.h"

namespace periost {
namespace {

constexpr std::uint8_t kVtkTetra = 10;
constexpr std::uint8_t kVtkQuadraticTetra = 24;

std::vector<std::int64_t> connectivity_of(const TetMesh& mesh) {
  std::vector<std::int64_t> ids;
  ids.reserve(mesh.tets.size() * (mesh.order() == 2 ? 10 : 4));
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    ids.insert(ids.end(), mesh.tets[t].begin(), mesh.tets[t].end());
    if (mesh.order() == 2) ids.insert(ids.end(), mesh.midside[t].begin(), mesh.midside[t].end());
  }
  return ids;
}

}  // namespace

void write_vtu(const TetMesh& mesh, const std::filesystem::path& path) {
  const bool is_quadratic = mesh.order() == 2;
  const std::vector<std::int64_t> connectivity = connectivity_of(mesh);
  const std::vector<std::int64_t> offsets = vtk_offsets(mesh.tets.size(), is_quadratic ? 10 : 4);
  const std::vector<std::uint8_t> types(mesh.tets.size(), is_quadratic ? kVtkQuadraticTetra : kVtkTetra);
  std::vector<std::int64_t> boundary;
  boundary.reserve(3 * mesh.boundary.size());
  for (const Triangle& t : mesh.boundary) boundary.insert(boundary.end(), t.begin(), t.end());
  const std::vector<double> voxel{mesh.voxel_mm};
  const std::vector<std::uint8_t> preserved{static_cast<std::uint8_t>(mesh.boundary_preserved ? 1 : 0)};

  std::vector<VtkXmlArray> field_data{vtk_array("boundary_preserved", preserved)};
  if (!mesh.boundary.empty()) field_data.push_back(vtk_array("boundary", boundary, 3));
  if (mesh.voxel_mm > 0) field_data.push_back(vtk_array("voxel_mm", voxel));
  std::vector<VtkXmlArray> cell_data = vtk_arrays(mesh.tet_fields);
  if (!mesh.region.empty()) cell_data.push_back(vtk_array("region", mesh.region));
  write_vtk_xml(
      path, "UnstructuredGrid",
      fmt::format(R"(NumberOfPoints="{}" NumberOfCells="{}")", mesh.points.size(), mesh.tets.size()),
      field_data,
      {{"PointData", vtk_arrays(mesh.point_fields)},
       {"CellData", cell_data},
       {"Points", {vtk_array("Points", mesh.points)}},
       {"Cells",
        {vtk_array("connectivity", connectivity), vtk_array("offsets", offsets),
         vtk_array("types", types)}}});
}

}  // namespace periost
