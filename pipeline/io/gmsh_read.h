#pragma once
// Meshes as Gmsh writes them (.msh): versions 2 (2.0 to 2.2) and 4.1, ASCII and binary of both byte orders.
#include <filesystem>

#include "pipeline/io/mesh_builder.h"

namespace periost {

// Tetrahedra of first or second order, else triangles; points and lines are passed over, and so are the
// triangles beside tetrahedra. `region` is the number of the volume (the elementary entity) that an element
// belongs to. Second-order nodes come in VTK's order: Gmsh's last two are the other way round. Sections other
// than $Nodes and $Elements are skipped.
// Throws Error{kInput} with line or byte: "mesh.malformed", "mesh.truncated", "mesh.unsupported" (another
// version; an element that is no tetrahedron, named), "mesh.bad_index", "mesh.not_finite", "mesh.empty",
// "file.unreadable". Memory follows from the file's size, never from a count in it.
AnyMesh read_gmsh(const std::filesystem::path& path);

}  // namespace periost
