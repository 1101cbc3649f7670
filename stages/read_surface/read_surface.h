#pragma once
// Reads a surface that was made elsewhere, so that a chain can start from it instead of from an image.
#include <filesystem>

#include "pipeline/base/context.h"
#include "pipeline/data/surface_mesh.h"

namespace periost {

// What the file's numbers are in; surface formats do not say.
enum class SurfaceUnit { kMicrometre, kMillimetre, kCentimetre, kMetre };

// The patient frame of the file's coordinates.
enum class SurfaceFrame { kLps, kRas };

// What is asked of the surface besides finite points and valid indices.
enum class SurfaceRequirement {
  kClosedManifold,  // closed, a manifold, neighbours oriented alike
  kAny,             // nothing: stages that need more check on their own
};

struct ReadSurfaceOptions {
  std::filesystem::path path;  // the file: .stl .ply .obj .off .vtp .vtk
  SurfaceUnit unit = SurfaceUnit::kMillimetre;
  SurfaceFrame frame = SurfaceFrame::kLps;
  SurfaceRequirement require = SurfaceRequirement::kClosedManifold;
};

// Reads (io/surface_read.h: equal points merged, was_read set) and converts to LPS millimetres. A required
// surface whose enclosed volume is negative is turned, so that normals point outward, with the warning
// "surface.turned". Sizes that suggest another unit are warned about ("surface.unit"). Self-intersections
// are left to the stages that mind them. Throws Error{kInput}: as the reader; "surface.not_finite" when
// coordinates overflow in mm; "surface.degenerate", "surface.open", "surface.not_manifold" or
// "surface.misoriented" with counts and the first place of each fault in mm, after the conversion.
// O(n log n), independent of threads.
SurfaceMesh read_surface(const ReadSurfaceOptions& options, const Context& context);

// Upper estimate of the triangles in a file that exists, from its size; no bytes are read.
std::uint64_t estimate_triangles(const std::filesystem::path& path);

}  // namespace periost
