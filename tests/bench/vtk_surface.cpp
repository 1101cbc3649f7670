#include "tests/bench/vtk_surface.h"

#include <vtkCellArray.h>
#include <vtkPoints.h>

namespace periost {

vtkNew<vtkPolyData> to_vtk(const SurfaceMesh& surface) {
  vtkNew<vtkPolyData> data;
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (const Vec3& p : surface.points) points->InsertNextPoint(p.x, p.y, p.z);
  vtkNew<vtkCellArray> cells;
  for (const auto& [a, b, c] : surface.triangles) {
    const vtkIdType ids[3] = {a, b, c};
    cells->InsertNextCell(3, ids);
  }
  data->SetPoints(points);
  data->SetPolys(cells);
  return data;
}

SurfaceMesh from_vtk(vtkPolyData* data, double voxel_mm) {
  SurfaceMesh surface;
  surface.voxel_mm = voxel_mm;
  for (vtkIdType i = 0; i < data->GetNumberOfPoints(); ++i) {
    const double* p = data->GetPoint(i);
    surface.points.push_back({p[0], p[1], p[2]});
  }
  vtkIdType count = 0;
  const vtkIdType* ids = nullptr;
  for (vtkCellArray* cells = data->GetPolys(); cells->GetNextCell(count, ids);) {
    surface.triangles.push_back(
        {static_cast<Index>(ids[0]), static_cast<Index>(ids[1]), static_cast<Index>(ids[2])});
  }
  return surface;
}

}  // namespace periost
