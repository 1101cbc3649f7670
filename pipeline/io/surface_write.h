#pragma once
// Writes a surface. All files are in LPS millimetres, the same bits from run to run, without a date, and
// appear whole or not at all.
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/data/surface_mesh.h"

namespace periost {

enum class SurfaceFormat {
  kStl,  // binary, single precision by the format's nature, one facet normal each; no fields
  kPly,  // binary little-endian, double precision, fields as float properties
  kObj,  // text, shortest decimals that read back to the same double; no fields
  kOff,  // text, likewise; no fields
  kVtp,  // VTK XML, double precision, fields, and `voxel_mm` as field data
};

// "stl", "ply", "obj", "off", "vtp": also the files' extensions.
const std::vector<std::string>& surface_format_names();
std::optional<SurfaceFormat> surface_format_from_name(std::string_view name);
const std::string& name_of(SurfaceFormat format);

// Precondition: indices below the number of points, fields as long as what they belong to.
// Throws Error{kLimit, "file.disk_full" | "file.unwritable"}.
void write_surface(const SurfaceMesh& mesh, const std::filesystem::path& path, SurfaceFormat format);

// The format follows from the extension. Throws Error{kUsage, "surface.unknown_format"} as well.
void write_surface(const SurfaceMesh& mesh, const std::filesystem::path& path);

}  // namespace periost
