#pragma once
// Meshes from VTK's files, XML and legacy. Indices are checked; coordinates are not.
#include <filesystem>

#include "pipeline/io/mesh_builder.h"

namespace periost {

// Triangles, strips and polygons of a .vtp, .vtu or .vtk. Throws Error{kInput, "surface.malformed"}.
SurfaceMesh read_vtk_surface(const std::filesystem::path& path);

// A .vtu or .vtk of tetrahedra (of one order) gives a TetMesh, else a surface of what faces there are. Lines
// and faces beside tetrahedra are passed over. Throws Error{kInput, "mesh.malformed" | "mesh.truncated" |
// "mesh.unsupported" (another solid element, with its place) | "mesh.bad_index" | "mesh.not_finite" |
// "mesh.empty"}.
AnyMesh read_vtk_mesh(const std::filesystem::path& path);

}  // namespace periost
