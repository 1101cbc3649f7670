#pragma once
// Writes a tetrahedral mesh as VTK XML unstructured grid (.vtu), in LPS millimetres and double precision.
#include <filesystem>

#include "pipeline/data/tet_mesh.h"

namespace periost {

// First order: VTK_TETRA; second order: VTK_QUADRATIC_TETRA. Cell data: `region` (32-bit) and the fields;
// point data: the fields; field data: `boundary` (the outward triangles, three point ids each), `voxel_mm`
// and `boundary_preserved`. The same mesh gives the same bits; the file appears whole or not at all.
// Precondition: indices below the number of points, fields as long as what they belong to.
// Throws Error{kLimit, "file.disk_full" | "file.unwritable"}.
void write_vtu(const TetMesh& mesh, const std::filesystem::path& path);

}  // namespace periost
