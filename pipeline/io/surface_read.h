#pragma once
// Reads a surface: STL (binary and ASCII), PLY (binary and ASCII, both byte orders), OBJ, OFF, VTP and legacy
// VTK.
#include <filesystem>

#include "pipeline/data/surface_mesh.h"

namespace periost {

// The format follows from the extension. Coordinates are taken as LPS millimetres; polygons are cut into
// fans; exactly equal points are merged, which gives an STL its connectivity, and `was_read` is set. VTP and
// PLY keep fields of one number, on points and on faces; VTP keeps `voxel_mm`. Throws Error{kInput}: as
// check_surface_file, "file.unreadable", "surface.truncated", "surface.malformed" (with the line or element),
// "surface.bad_index", "surface.not_finite", "surface.empty". Never trusts a count in the file: memory
// follows from the file's size.
SurfaceMesh read_surface(const std::filesystem::path& path);

// Throws Error{kInput}: "surface.missing" unless `path` is a file, "surface.unknown_format" unless its
// extension is one of those above. Nothing is read.
void check_surface_file(const std::filesystem::path& path);

// Whether the extension is that of an STL file, in any case.
bool is_stl_file(const std::filesystem::path& path);

// Merges points with equal coordinates (-0 equals 0); each keeps the place of its first. Point fields keep
// the first value. O(n log n).
void merge_equal_points(SurfaceMesh& mesh);

}  // namespace periost
