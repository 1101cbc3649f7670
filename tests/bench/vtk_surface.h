#pragma once
// Surfaces to VTK's filters and back, for comparisons with them.
#include <vtkNew.h>
#include <vtkPolyData.h>

#include "pipeline/data/surface_mesh.h"

namespace periost {

// Points in double precision, triangles in the same order.
vtkNew<vtkPolyData> to_vtk(const SurfaceMesh& surface);

// Precondition: all polygons are triangles.
SurfaceMesh from_vtk(vtkPolyData* data, double voxel_mm);

}  // namespace periost
