#include "stages/read_surface/read_surface.h"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>
#include <utility>

#include "pipeline/base/error.h"
#include "pipeline/geometry/topology.h"
#include "pipeline/io/surface_read.h"

namespace periost {
namespace {

// Longest side of the box, in mm, that bones and organs have; outside it the unit is doubtful.
constexpr double kLeastSize = 1, kLargestSize = 3000;

double mm_per_unit(SurfaceUnit unit) {
  switch (unit) {
    case SurfaceUnit::kMicrometre:
      return 1e-3;
    case SurfaceUnit::kMillimetre:
      return 1;
    case SurfaceUnit::kCentimetre:
      return 10;
    case SurfaceUnit::kMetre:
      return 1000;
  }
  return 1;
}

// RAS to LPS is half a turn about z, which keeps the orientation of triangles.
void convert(SurfaceMesh& surface, const ReadSurfaceOptions& options) {
  const double scale = mm_per_unit(options.unit);
  const double turn = options.frame == SurfaceFrame::kRas ? -1 : 1;
  for (Vec3& p : surface.points) p = {turn * scale * p.x, turn * scale * p.y, scale * p.z};
}

void check_points(const SurfaceMesh& surface, const std::filesystem::path& path) {
  const auto bad =
      std::find_if(surface.points.begin(), surface.points.end(), [](Vec3 p) { return !is_finite(p); });
  if (bad == surface.points.end()) return;
  throw Error(ErrorKind::kInput, "surface.not_finite",
              fmt::format("'{}': point {} is too far away to be a number in mm", path.string(),
                          bad - surface.points.begin()),
              "check `unit`");
}

void check_topology(const SurfaceMesh& surface, const std::filesystem::path& path) {
  const Topology topology = examine_topology(surface);
  const std::string code = violation_code(topology);
  if (code.empty()) return;
  throw Error(ErrorKind::kInput, code,
              fmt::format("'{}' is not a closed manifold: {}", path.string(), describe_violations(topology)),
              "repair the surface, or set `require: any` if no later stage needs a closed one");
}

void turn_outward(SurfaceMesh& surface, const Context& context) {
  if (signed_volume(surface) >= 0) return;
  for (Triangle& triangle : surface.triangles) std::swap(triangle[1], triangle[2]);
  context.warn("surface.turned", "the normals of the surface pointed inward; its triangles were turned");
}

void report_size(const SurfaceMesh& surface, const Context& context) {
  Vec3 low = surface.points[surface.triangles[0][0]], high = low;
  for (const Triangle& triangle : surface.triangles) {
    for (const Index corner : triangle) {
      for (std::size_t k = 0; k < 3; ++k) {
        low[k] = std::min(low[k], surface.points[corner][k]);
        high[k] = std::max(high[k], surface.points[corner][k]);
      }
    }
  }
  const Vec3 size = high - low;
  const std::string text = fmt::format("{} triangles in a box of {:.4g} x {:.4g} x {:.4g} mm",
                                       surface.triangles.size(), size.x, size.y, size.z);
  const double longest = std::max({size.x, size.y, size.z});
  if (longest < kLeastSize || longest > kLargestSize) {
    context.warn("surface.unit", text + ": is `unit` right?");
  } else {
    context.info("surface.read", text);
  }
}

}  // namespace

SurfaceMesh read_surface(const ReadSurfaceOptions& options, const Context& context) {
  SurfaceMesh surface = read_surface(options.path);
  convert(surface, options);
  check_points(surface, options.path);
  if (options.require == SurfaceRequirement::kClosedManifold) {
    check_topology(surface, options.path);
    turn_outward(surface, context);
  }
  report_size(surface, context);
  return surface;
}

std::uint64_t estimate_triangles(const std::filesystem::path& path) {
  // A facet of a binary STL has 50 bytes; elsewhere a triangle and its half of a point take 25 or more.
  std::error_code unknown_size;
  const std::uintmax_t bytes = std::filesystem::file_size(path, unknown_size);
  if (unknown_size) return 0;
  return bytes / (is_stl_file(path) ? 50 : 25);
}

}  // namespace periost
