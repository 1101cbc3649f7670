#pragma once
// PLY files, ASCII and binary of both byte orders.
#include <filesystem>

#include "pipeline/data/surface_mesh.h"

namespace periost {

// Vertices with their scalar properties as point fields; polygons cut into fans, with their scalar properties
// as triangle fields. Indices are not checked.
// Throws Error{kInput}: "surface.malformed" or "surface.truncated", with the element.
SurfaceMesh read_ply(const std::filesystem::path& path);

}  // namespace periost
