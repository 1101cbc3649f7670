#include "pipeline/io/vtk_mesh_read.h"

#include <fmt/format.h>
#include <vtkCell.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkCellTypes.h>
#include <vtkDataArray.h>
#include <vtkDataSetReader.h>
#include <vtkFieldData.h>
#include <vtkLogger.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLPolyDataReader.h>
#include <vtkXMLUnstructuredGridReader.h>

#include <cstdlib>
#include <new>

#include "pipeline/base/file.h"
#include "pipeline/io/text_header.h"
#include "pipeline/io/text_scanner.h"

namespace periost {
namespace {

using Path = std::filesystem::path;

[[noreturn]] void fail(const char* code, const Path& path, const std::string& what) {
  refuse_mesh(code, fmt::format("'{}'", path.string()), what);
}

[[noreturn]] void fail_count(const Path& path, std::string_view key, double count) {
  refuse_mesh("mesh.truncated", fmt::format("'{}'", path.string()),
              fmt::format("{} of {:.0f} is more than the file can hold", key, count),
              "copy or export the file again: its end is missing");
}

// Refuses counts that the file's size cannot hold, before VTK takes memory for them. Compressed blocks shrink
// by at most a thousand.
void check_xml_counts(const Path& path, const std::string& text) {
  for (const char* key : {"NumberOfPoints=\"", "NumberOfCells=\"", "NumberOfPolys=\"", "NumberOfTuples=\"",
                          "NumberOfStrips=\"", "NumberOfLines=\"", "NumberOfVerts=\""}) {
    for (std::size_t at = text.find(key); at != std::string::npos; at = text.find(key, at + 1)) {
      const double count = std::strtod(text.c_str() + at + std::string_view(key).size(), nullptr);
      if (!(count >= 0) || count > 1000.0 * static_cast<double>(text.size())) {
        fail_count(path, std::string_view(key).substr(0, std::string_view(key).find('=')), count);
      }
    }
  }
}

// The same for the keywords of legacy files, each at the start of a line and followed by one or two counts.
// Every value takes at least a byte, a bit in arrays of bits.
void check_legacy_counts(const Path& path, const std::string& text) {
  for (const std::string_view key :
       {"POINTS ", "CELLS ", "CELL_TYPES ", "POLYGONS ", "VERTICES ", "LINES ", "TRIANGLE_STRIPS ",
        "OFFSETS ", "CONNECTIVITY ", "POINT_DATA ", "CELL_DATA ", "FIELD "}) {
    for (std::size_t at = text.find(key); at != std::string::npos; at = text.find(key, at + 1)) {
      if (at > 0 && text[at - 1] != '\n') continue;
      TextScanner line(std::string_view(text).substr(at));
      line.word();
      for (std::string_view word = line.word_in_line(); !word.empty(); word = line.word_in_line()) {
        double count = 0;
        std::from_chars(word.data(), word.data() + word.size(), count);
        if (!(count >= 0) || count > 8.0 * static_cast<double>(text.size())) {
          fail_count(path, key.substr(0, key.size() - 1), count);
        }
      }
    }
  }
}

// VTK prints what it dislikes to standard error; our own sentence is enough.
class QuietVtk {
 public:
  QuietVtk() : display_(vtkObject::GetGlobalWarningDisplay()), log_(vtkLogger::GetCurrentVerbosityCutoff()) {
    vtkObject::SetGlobalWarningDisplay(0);
    vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
  }
  ~QuietVtk() {
    vtkObject::SetGlobalWarningDisplay(display_);
    vtkLogger::SetStderrVerbosity(log_);
  }
  QuietVtk(const QuietVtk&) = delete;
  QuietVtk& operator=(const QuietVtk&) = delete;

 private:
  int display_;
  vtkLogger::Verbosity log_;
};

template <class Reader>
vtkSmartPointer<vtkDataSet> read_with(const Path& path) {
  const std::string text = read_text(path);
  check_xml_counts(path, text);
  check_legacy_counts(path, text);
  const QuietVtk quiet;
  vtkNew<Reader> reader;
  reader->SetFileName(path.c_str());
  try {
    reader->Update();
  } catch (const std::bad_alloc&) {
    fail("mesh.malformed", path, "it announces more than the memory holds");
  }
  vtkSmartPointer<vtkDataSet> data = vtkDataSet::SafeDownCast(reader->GetOutputDataObject(0));
  if (data == nullptr || reader->GetErrorCode() != 0) fail("mesh.malformed", path, "VTK cannot read it");
  return data;
}

vtkSmartPointer<vtkDataSet> read_data(const Path& path) {
  const std::string extension = lower_case(path.extension().string());
  if (extension == ".vtp") return read_with<vtkXMLPolyDataReader>(path);
  if (extension == ".vtu") return read_with<vtkXMLUnstructuredGridReader>(path);
  return read_with<vtkDataSetReader>(path);
}

// Offsets ascend within the connectivity and every id is a point.
void check_cells(const Path& path, vtkCellArray* cells, vtkIdType points) {
  if (cells == nullptr) return;
  vtkDataArray* offsets = cells->GetOffsetsArray();
  vtkDataArray* ids = cells->GetConnectivityArray();
  double before = 0;
  for (vtkIdType i = 0; i < offsets->GetNumberOfTuples(); ++i) {
    const double offset = offsets->GetTuple1(i);
    if (offset < before || offset > static_cast<double>(ids->GetNumberOfTuples())) {
      fail("mesh.malformed", path, fmt::format("cell {} lies outside the list of corners", i));
    }
    before = offset;
  }
  for (vtkIdType i = 0; i < ids->GetNumberOfTuples(); ++i) {
    const double id = ids->GetTuple1(i);
    if (!(id >= 0 && id < static_cast<double>(points))) {
      fail("mesh.bad_index", path,
           fmt::format("entry {} of the cells names point {:.0f} of {}", i, id, points));
    }
  }
}

Fields fields_of(vtkFieldData* data, std::size_t count) {
  Fields fields;
  for (int a = 0; a < data->GetNumberOfArrays(); ++a) {
    vtkDataArray* array = vtkDataArray::SafeDownCast(data->GetAbstractArray(a));
    if (array == nullptr || array->GetName() == nullptr || array->GetNumberOfComponents() != 1 ||
        static_cast<std::size_t>(array->GetNumberOfTuples()) != count) {
      continue;
    }
    std::vector<float>& values = fields[array->GetName()];
    for (vtkIdType i = 0; i < array->GetNumberOfTuples(); ++i) {
      values.push_back(static_cast<float>(array->GetTuple1(i)));
    }
  }
  return fields;
}

double scalar_of(vtkDataSet& data, const char* name, double absent) {
  vtkDataArray* array = data.GetFieldData()->GetArray(name);
  return array != nullptr && array->GetNumberOfTuples() > 0 ? array->GetTuple1(0) : absent;
}

std::vector<Vec3> points_of(vtkPointSet& data) {
  std::vector<Vec3> points(static_cast<std::size_t>(data.GetNumberOfPoints()));
  for (std::size_t p = 0; p < points.size(); ++p) data.GetPoint(static_cast<vtkIdType>(p), &points[p].x);
  return points;
}

void check_all(const Path& path, vtkPointSet& data) {
  if (auto* grid = vtkUnstructuredGrid::SafeDownCast(&data))
    check_cells(path, grid->GetCells(), data.GetNumberOfPoints());
  if (auto* poly = vtkPolyData::SafeDownCast(&data)) {
    for (vtkCellArray* cells : {poly->GetPolys(), poly->GetStrips(), poly->GetLines(), poly->GetVerts()}) {
      check_cells(path, cells, data.GetNumberOfPoints());
    }
  }
}

SurfaceMesh surface_of(vtkPointSet& data) {
  SurfaceMesh mesh;
  mesh.points = points_of(data);
  vtkNew<vtkIdList> ids;
  for (vtkIdType c = 0; c < data.GetNumberOfCells(); ++c) {
    const int type = data.GetCellType(c);
    data.GetCellPoints(c, ids);
    const auto id = [&](vtkIdType k) { return static_cast<Index>(ids->GetId(k)); };
    for (vtkIdType k = 2; k < ids->GetNumberOfIds(); ++k) {
      if (type == VTK_TRIANGLE || type == VTK_POLYGON || type == VTK_QUAD) {
        mesh.triangles.push_back({id(0), id(k - 1), id(k)});
      } else if (type == VTK_TRIANGLE_STRIP) {
        mesh.triangles.push_back(k % 2 == 0 ? Triangle{id(k - 2), id(k - 1), id(k)}
                                            : Triangle{id(k - 1), id(k - 2), id(k)});
      }
    }
  }
  mesh.point_fields = fields_of(data.GetPointData(), mesh.points.size());
  mesh.triangle_fields = fields_of(data.GetCellData(), mesh.triangles.size());
  mesh.voxel_mm = scalar_of(data, "voxel_mm", 0);
  return mesh;
}

// Points, lines and faces may stand beside tetrahedra; other solids would be missing from the measurement.
void check_is_no_solid(const Path& path, vtkPointSet& data, vtkIdType c) {
  vtkCell* cell = data.GetCell(c);
  if (cell->GetCellDimension() < 3) return;
  const std::string_view name = vtkCellTypes::GetClassNameFromTypeId(cell->GetCellType());
  Vec3 at;
  if (cell->GetNumberOfPoints() > 0) data.GetPoint(cell->GetPointId(0), &at.x);
  refuse_mesh("mesh.unsupported", fmt::format("'{}'", path.string()),
              fmt::format("cell {} at ({:.2f}, {:.2f}, {:.2f}) is a {}", c, at.x, at.y, at.z,
                          name.substr(name.rfind("vtk", 0) == 0 ? 3 : 0)),
              "only tetrahedra of first and second order are measured: split the others, or leave them out");
}

TetMesh tets_of(const Path& path, vtkPointSet& data) {
  TetMesh mesh;
  mesh.points = points_of(data);
  vtkNew<vtkIdList> ids;
  for (vtkIdType c = 0; c < data.GetNumberOfCells(); ++c) {
    const int type = data.GetCellType(c);
    data.GetCellPoints(c, ids);
    const auto id = [&](vtkIdType k) { return static_cast<Index>(ids->GetId(k)); };
    if (type != VTK_TETRA && type != VTK_QUADRATIC_TETRA) {
      check_is_no_solid(path, data, c);
      continue;
    }
    if (ids->GetNumberOfIds() != (type == VTK_TETRA ? 4 : 10)) {
      fail("mesh.malformed", path, fmt::format("cell {} has {} corners", c, ids->GetNumberOfIds()));
    }
    mesh.tets.push_back({id(0), id(1), id(2), id(3)});
    if (type == VTK_QUADRATIC_TETRA) mesh.midside.push_back({id(4), id(5), id(6), id(7), id(8), id(9)});
  }
  if (!mesh.midside.empty() && mesh.midside.size() != mesh.tets.size()) {
    fail("mesh.unsupported", path, "it mixes tetrahedra of first and second order");
  }
  mesh.point_fields = fields_of(data.GetPointData(), mesh.points.size());
  mesh.tet_fields = fields_of(data.GetCellData(), mesh.tets.size());
  if (const auto region = mesh.tet_fields.find("region"); region != mesh.tet_fields.end()) {
    for (const float value : region->second) mesh.region.push_back(static_cast<std::int32_t>(value));
    mesh.tet_fields.erase(region);
  }
  vtkDataArray* boundary = data.GetFieldData()->GetArray("boundary");
  for (vtkIdType t = 0;
       boundary != nullptr && boundary->GetNumberOfComponents() == 3 && t < boundary->GetNumberOfTuples();
       ++t) {
    Triangle triangle;
    for (int k = 0; k < 3; ++k) {
      const double id = boundary->GetComponent(t, k);
      if (!(id >= 0 && id < static_cast<double>(mesh.points.size()))) {
        fail("mesh.bad_index", path,
             fmt::format("boundary triangle {} names a point that does not exist", t));
      }
      triangle[static_cast<std::size_t>(k)] = static_cast<Index>(id);
    }
    mesh.boundary.push_back(triangle);
  }
  mesh.voxel_mm = scalar_of(data, "voxel_mm", 0);
  mesh.boundary_preserved = scalar_of(data, "boundary_preserved", 1) != 0;
  return mesh;
}

vtkSmartPointer<vtkDataSet> checked_data(const Path& path) {
  vtkSmartPointer<vtkDataSet> data = read_data(path);
  auto* points = vtkPointSet::SafeDownCast(data);
  if (points == nullptr || points->GetPoints() == nullptr) fail("mesh.empty", path, "it holds no points");
  check_all(path, *points);
  return data;
}

}  // namespace

SurfaceMesh read_vtk_surface(const Path& path) {
  const vtkSmartPointer<vtkDataSet> data = checked_data(path);
  return surface_of(*vtkPointSet::SafeDownCast(data));
}

AnyMesh read_vtk_mesh(const Path& path) {
  const vtkSmartPointer<vtkDataSet> data = checked_data(path);
  TetMesh tets = tets_of(path, *vtkPointSet::SafeDownCast(data));
  for (std::size_t p = 0; p < tets.points.size(); ++p) {
    if (!is_finite(tets.points[p])) {
      fail("mesh.not_finite", path, fmt::format("point {} has a coordinate that is not finite", p));
    }
  }
  if (!tets.tets.empty()) return tets;
  SurfaceMesh surface = surface_of(*vtkPointSet::SafeDownCast(data));
  if (surface.triangles.empty()) fail("mesh.empty", path, "it holds neither tetrahedra nor triangles");
  surface.was_read = true;
  return surface;
}

}  // namespace periost
