#pragma once
// Writes a simplex mesh as VTK XML polygons (.vtp): one polygon per closed face, seen from outside
// counter-clockwise.
#include <filesystem>

#include "pipeline/data/simplex_mesh.h"

namespace periost {

// LPS millimetres, double precision; the face fields are cell data. Faces that an open surface cuts are left
// out, with their values. The same mesh gives the same bits; the file appears whole or not at all. Throws
// Error{kLimit, "file.disk_full" | "file.unwritable"}.
void write_simplex_vtp(const SimplexMesh& mesh, const std::filesystem::path& path);

}  // namespace periost
