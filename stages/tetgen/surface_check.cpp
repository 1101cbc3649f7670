#include "stages/tetgen/surface_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "pipeline/base/error.h"
#include "pipeline/geometry/predicates.h"
#include "pipeline/geometry/self_intersection.h"
#include "pipeline/geometry/topology.h"
#include "pipeline/io/surface_write.h"

namespace periost {
namespace {

constexpr char kFaultFile[] = "surface_faults.vtp";
constexpr std::size_t kDrawn = 10000;  // triangles in the fault file, at most
constexpr std::size_t kNamed = 3;      // places in the sentence

Vec3 centre_of(const SurfaceMesh& surface, Index triangle) {
  const auto& [a, b, c] = surface.triangles[triangle];
  return (surface.points[a] + surface.points[b] + surface.points[c]) / 3;
}

// Writes the offending triangles; returns " (drawn in FILE)", or nothing where there is no folder to put it.
std::string draw(const SurfaceMesh& surface, const std::set<Index>& triangles, const Context& context) {
  if (context.output.empty() || triangles.empty()) return {};
  SurfaceMesh faults;
  for (const Index t : triangles) {
    const auto first = static_cast<Index>(faults.points.size());
    for (const Index corner : surface.triangles[t]) faults.points.push_back(surface.points[corner]);
    faults.triangles.push_back({first, first + 1, first + 2});
    if (faults.triangles.size() == kDrawn) break;
  }
  write_surface(faults, context.output / kFaultFile, SurfaceFormat::kVtp);
  return fmt::format(" (drawn in {})", kFaultFile);
}

[[noreturn]] void fail(const SurfaceMesh& surface, const char* code, const std::string& what,
                       const std::string& drawn) {
  const char* whose = surface.was_read ? "the surface that was read" : "the surface that the chain made";
  throw Error(surface.was_read ? ErrorKind::kInput : ErrorKind::kQuality, code,
              fmt::format("{} cannot be filled: {}{}", whose, what, drawn),
              surface.was_read
                  ? "repair the surface, or start the chain from an image"
                  : "keep the largest component, close the surface at the image border, or decimate less");
}

std::string places(const std::vector<Vec3>& at) {
  std::string text;
  for (std::size_t i = 0; i < std::min(at.size(), kNamed); ++i) {
    text += fmt::format("{}({:.2f}, {:.2f}, {:.2f})", i == 0 ? "" : ", ", at[i].x, at[i].y, at[i].z);
  }
  return text + " mm";
}

void check_indices(const SurfaceMesh& surface) {
  if (surface.triangles.empty()) fail(surface, "surface.empty", "it has no triangles", {});
  for (const Triangle& triangle : surface.triangles) {
    for (const Index corner : triangle) {
      if (corner >= surface.points.size()) {
        fail(surface, "surface.not_manifold",
             fmt::format("a triangle names point {}, which does not exist", corner), {});
      }
    }
  }
}

void check_topology(const SurfaceMesh& surface, const Context& context) {
  const Topology topology = examine_topology(surface, 1000);
  const std::string code = violation_code(topology);
  if (code.empty()) return;
  std::set<Index> triangles;
  for (const ViolationPlace& place : topology.places) {
    // A pinched vertex is a point; its triangles would have to be searched for, and the sentence names it.
    const bool is_point = place.kind == Violation::kPinchedVertex || place.kind == Violation::kNonFinitePoint;
    if (!is_point) triangles.insert(place.element);
  }
  fail(surface, code.c_str(), describe_violations(topology),
       topology.is_finite() ? draw(surface, triangles, context) : std::string());
}

void check_areas(const SurfaceMesh& surface, const Context& context) {
  std::set<Index> flat;
  std::vector<Vec3> at;
  for (Index t = 0; t < surface.triangles.size(); ++t) {
    const auto& [a, b, c] = surface.triangles[t];
    if (!is_degenerate({surface.points[a], surface.points[b], surface.points[c]})) continue;
    flat.insert(t);
    if (at.size() < kNamed) at.push_back(centre_of(surface, t));
  }
  if (flat.empty()) return;
  fail(surface, "surface.degenerate",
       fmt::format("{} triangle{} without area, at {}", flat.size(), flat.size() == 1 ? "" : "s", places(at)),
       draw(surface, flat, context));
}

void check_intersections(const SurfaceMesh& surface, const Context& context) {
  const auto pairs = self_intersections(surface, context);
  if (pairs.empty()) return;
  std::set<Index> triangles;
  std::vector<Vec3> at;
  for (const auto& [i, j] : pairs) {
    if (at.size() < kNamed) at.push_back(0.5 * (centre_of(surface, i) + centre_of(surface, j)));
    triangles.insert({i, j});
  }
  fail(surface, "surface.self_intersection",
       fmt::format("it intersects itself at {} pair{} of triangles, near {}", pairs.size(),
                   pairs.size() == 1 ? "" : "s", places(at)),
       draw(surface, triangles, context));
}

}  // namespace

void check_fillable(const SurfaceMesh& surface, const Context& context) {
  check_indices(surface);
  check_topology(surface, context);
  check_areas(surface, context);
  check_intersections(surface, context);
}

}  // namespace periost
