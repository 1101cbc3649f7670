#pragma once
// Meshes as TetGen writes them: NAME.node with the points and NAME.ele with the tetrahedra.
#include <filesystem>

#include "pipeline/io/mesh_builder.h"

namespace periost {

// `path` is either of the two files; the other is found beside it. Numbers may start at 0 or 1; attributes
// and markers of points are passed over; the first attribute of an element is its `region` (else 1); ten
// nodes an element are second order, brought into VTK's order. TetGen itself reads tetrahedra turned either
// way, so where most of the volume is negative all of them are turned.
// Throws Error{kInput} with file and line: "mesh.missing" (one of the two), "mesh.malformed",
// "mesh.truncated", "mesh.unsupported", "mesh.bad_index", "mesh.not_finite", "mesh.empty".
AnyMesh read_tetgen(const std::filesystem::path& path);

}  // namespace periost
