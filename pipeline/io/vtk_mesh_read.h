#pragma once
// Meshes from VTK's files, XML and legacy. Indices are checked; coordinates are not.
#include <filesystem>
#include <variant>

#include "pipeline/data/surface_mesh.h"
#include "pipeline/data/tet_mesh.h"

namespace periost {

// Triangles, strips and polygons of a .vtp, .vtu or .vtk. Throws Error{kInput, "surface.malformed"}.
SurfaceMesh read_vtk_surface(const std::filesystem::path& path);

// A .vtu or .vtk of tetrahedra (of one order) gives a TetMesh, else a surface of what faces there are.
// Throws Error{kInput, "mesh.malformed" | "mesh.bad_index" | "mesh.empty"}.
std::variant<SurfaceMesh, TetMesh> read_vtk_mesh(const std::filesystem::path& path);

}  // namespace periost
