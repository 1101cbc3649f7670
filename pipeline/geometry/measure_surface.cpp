#include "pipeline/geometry/measure_surface.h"

#include <cmath>
#include <numbers>

#include "pipeline/base/error.h"
#include "pipeline/base/parallel.h"
#include "pipeline/geometry/distribution.h"
#include "pipeline/geometry/extremes.h"
#include "pipeline/geometry/self_intersection.h"
#include "pipeline/geometry/simplex_dual.h"
#include "pipeline/geometry/simplex_geometry.h"
#include "pipeline/geometry/topology.h"
#include "pipeline/geometry/triangle_quality.h"

namespace periost {
namespace {

constexpr std::size_t kTrianglesPerTask = 8192;
constexpr double kDegreesPerRadian = 180 / std::numbers::pi;

Vec3 centre_of(const SurfaceMesh& mesh, std::size_t t) {
  const auto& [a, b, c] = mesh.triangles[t];
  return (mesh.points[a] + mesh.points[b] + mesh.points[c]) / 3;
}

// Evaluates `metric(a, b, c)` for every triangle.
template <class Metric>
std::vector<double> per_triangle(const SurfaceMesh& mesh, const Context& context, Metric metric) {
  std::vector<double> values(mesh.triangles.size());
  parallel_blocks(context, values.size(), kTrianglesPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      const auto& [a, b, c] = mesh.triangles[t];
      values[t] = metric(mesh.points[a], mesh.points[b], mesh.points[c]);
    }
  });
  return values;
}

std::vector<WorstElement> worst_triangles(const SurfaceMesh& mesh, const std::vector<double>& values,
                                          Extremes::Side side) {
  Extremes extremes(side);
  for (std::size_t t = 0; t < values.size(); ++t) extremes.add(t, values[t], centre_of(mesh, t));
  return extremes.take();
}

double share_below(const std::vector<double>& values, double limit) {
  if (values.empty()) return 0;
  std::size_t below = 0;
  for (const double value : values) below += value < limit ? 1 : 0;
  return static_cast<double>(below) / static_cast<double>(values.size());
}

// Share of the vertices off the boundary that have five to seven edges.
double share_of_regular_valences(const SurfaceMesh& mesh) {
  std::vector<std::uint32_t> edges(mesh.points.size(), 0);
  std::vector<bool> on_boundary(mesh.points.size(), false);
  const auto uses = sorted_edge_uses(mesh.triangles, mesh.points.size());
  for (std::size_t begin = 0, end = 0; begin < uses.size(); begin = end) {
    const auto [a, b] = std::pair(uses[begin].a, uses[begin].b);
    for (end = begin; end < uses.size() && uses[end].a == a && uses[end].b == b;) ++end;
    ++edges[a];
    ++edges[b];
    if (end - begin == 1) on_boundary[a] = on_boundary[b] = true;
  }
  std::size_t inner = 0, regular = 0;
  for (std::size_t p = 0; p < edges.size(); ++p) {
    if (edges[p] == 0 || on_boundary[p]) continue;
    ++inner;
    regular += edges[p] >= 5 && edges[p] <= 7 ? 1 : 0;
  }
  return inner == 0 ? 0 : static_cast<double>(regular) / static_cast<double>(inner);
}

// The path under which places of a violation are listed.
const char* path_of(Violation kind) {
  switch (kind) {
    case Violation::kBoundaryEdge:
      return "surface.closed";
    case Violation::kMisorientedEdge:
      return "surface.oriented";
    default:
      return "surface.manifold";
  }
}

void measure_topology(const SurfaceMesh& surface, SurfaceQuality& quality, WorstElements& worst) {
  const Topology topology = examine_topology(surface, Extremes::kCount);
  quality.triangles = topology.triangles;
  quality.vertices = topology.vertices;
  quality.components = topology.components;
  quality.euler = topology.euler;
  quality.closed = topology.is_closed();
  quality.manifold = topology.is_manifold();
  quality.oriented = topology.is_oriented();
  for (const ViolationPlace& place : topology.places) {
    auto& places = worst[path_of(place.kind)];
    if (places.size() < Extremes::kCount) {
      places.push_back({place.element, 1, place.place_mm, name_of(place.kind)});
    }
  }
}

void measure_self_intersections(const SurfaceMesh& surface, const Context& context, SurfaceQuality& quality,
                                WorstElements& worst) {
  const auto pairs = self_intersections(surface, context);
  quality.self_intersections = pairs.size();
  for (const auto& [first, second] : pairs) {
    auto& places = worst["surface.self_intersections"];
    if (places.size() == Extremes::kCount) break;
    places.push_back({first, 1, centre_of(surface, first), "meets triangle " + std::to_string(second)});
  }
}

}  // namespace

IsosurfaceQuality measure_isosurface(const SurfaceMesh& isosurface, double voxel_mm) {
  const Topology topology = examine_topology(isosurface, 0);
  IsosurfaceQuality quality;
  quality.triangles = topology.triangles;
  quality.vertices = topology.vertices;
  quality.components = topology.components;
  quality.euler = topology.euler;
  quality.closed = topology.is_closed();
  quality.manifold = topology.is_manifold();
  quality.voxel_mm = voxel_mm;
  quality.volume_mm3 = signed_volume(isosurface);
  return quality;
}

SurfaceQuality measure_surface(const SurfaceMesh& surface, const MeasureOptions& options,
                               const Context& context, WorstElements& worst) {
  SurfaceQuality quality;
  measure_topology(surface, quality, worst);
  if (options.self_intersections) measure_self_intersections(surface, context, quality, worst);
  quality.area_mm2 = surface_area(surface);
  if (quality.closed) quality.volume_mm3 = signed_volume(surface);

  const std::vector<double> angles = per_triangle(surface, context, triangle_min_angle_deg);
  const std::vector<double> ratios = per_triangle(surface, context, triangle_radius_ratio);
  worst["surface.min_angle_deg"] = worst_triangles(surface, angles, Extremes::Side::kLowest);
  worst["surface.radius_ratio"] = worst_triangles(surface, ratios, Extremes::Side::kHighest);
  quality.min_angle_deg = distribution_of(angles);
  quality.radius_ratio = distribution_of(ratios);
  quality.share_below_20deg = share_below(angles, 20);
  quality.share_below_30deg = share_below(angles, 30);
  quality.valence_5_to_7 = share_of_regular_valences(surface);
  if (quality.manifold && quality.oriented) quality.simplex_angle_rms_deg = simplex_angle_rms_deg(surface);
  quality.normal_deviation_rms_deg = normal_deviation_rms_deg(surface);
  return quality;
}

std::optional<double> simplex_angle_rms_deg(const SurfaceMesh& surface) {
  SimplexMesh mesh;
  try {
    mesh = dual_simplex_mesh(surface);
  } catch (const Error&) {
    return std::nullopt;  // not an oriented manifold
  }
  const std::size_t count = mesh.position.size();
  const auto has_all = [&](std::size_t v) {
    for (const SimplexVertex n : mesh.neighbour[v]) {
      if (n == kNoVertex) return false;
    }
    return true;
  };
  std::vector<double> angle(count, std::nan(""));  // NaN: none
  for (std::size_t v = 0; v < count; ++v) {
    if (!has_all(v)) continue;
    const SimplexParameters parameters = simplex_parameters(mesh, SimplexVertex{static_cast<Index>(v)});
    if (!parameters.is_degenerate) angle[v] = simplex_angle(parameters);
  }
  double squares = 0;
  std::size_t used = 0;
  for (std::size_t v = 0; v < count; ++v) {
    if (std::isnan(angle[v])) continue;
    double mean = 0;
    for (const SimplexVertex n : mesh.neighbour[v]) mean += angle[index_of(n)] / 3;
    if (std::isnan(mean)) continue;
    squares += (angle[v] - mean) * (angle[v] - mean);
    ++used;
  }
  if (used == 0) return std::nullopt;
  return std::sqrt(squares / static_cast<double>(used)) * kDegreesPerRadian;
}

double normal_deviation_rms_deg(const SurfaceMesh& surface) {
  const auto neighbours = triangle_neighbours(surface.triangles, surface.points.size());
  const auto normal = [&](Index t) {
    const auto& [a, b, c] = surface.triangles[t];
    return area_vector(surface.points[a], surface.points[b], surface.points[c]);
  };
  double squares = 0;
  std::size_t used = 0;
  for (Index t = 0; t < surface.triangles.size(); ++t) {
    const Vec3 own = normal(t);
    for (const Index other : neighbours[t]) {
      if (other == kNoIndex || other < t) continue;
      const Vec3 theirs = normal(other);
      if (squared_norm(own) == 0 || squared_norm(theirs) == 0) continue;
      const double angle = std::atan2(norm(cross(own, theirs)), dot(own, theirs));
      squares += angle * angle;
      ++used;
    }
  }
  return used == 0 ? 0 : std::sqrt(squares / static_cast<double>(used)) * kDegreesPerRadian;
}

}  // namespace periost
