#include "laplacian_smoothing.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace smoothing_example {
namespace {

using periost::Index;
using periost::SurfaceMesh;
using periost::Vec3;

using Edge = std::pair<Index, Index>;

// Every edge once for each triangle at it, the smaller end first, sorted.
std::vector<Edge> edges_of(const SurfaceMesh& mesh) {
  std::vector<Edge> edges;
  edges.reserve(mesh.triangles.size() * 3);
  for (const periost::Triangle& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) edges.push_back(std::minmax(Index{t[k]}, Index{t[(k + 1) % 3]}));
  }
  std::sort(edges.begin(), edges.end());
  return edges;
}

// The ends of edges with a single triangle.
std::vector<bool> boundary_points(const std::vector<Edge>& edges, std::size_t points) {
  std::vector<bool> is_boundary(points, false);
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t end = i + 1;
    while (end < edges.size() && edges[end] == edges[i]) ++end;
    if (end == i + 1) is_boundary[edges[i].first] = is_boundary[edges[i].second] = true;
    i = end;
  }
  return is_boundary;
}

// Moves every inner point by `share` of the way to the mean of its neighbours.
void step(std::vector<Vec3>& points, const std::vector<Edge>& edges, const std::vector<bool>& is_fixed,
          double share) {
  std::vector<Vec3> sum(points.size());
  std::vector<double> count(points.size(), 0.0);
  for (const auto& [a, b] : edges) {
    sum[a] += points[b];
    sum[b] += points[a];
    count[a] += 1;
    count[b] += 1;
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!is_fixed[i] && count[i] > 0) points[i] += share * (sum[i] / count[i] - points[i]);
  }
}

}  // namespace

SurfaceMesh smooth(const SurfaceMesh& mesh, const LaplacianSmoothingOptions& options,
                   const periost::Context& context) {
  SurfaceMesh result = mesh;
  const std::vector<Edge> edges = edges_of(mesh);
  std::vector<Edge> unique = edges;
  unique.erase(std::unique(unique.begin(), unique.end()), unique.end());
  const std::vector<bool> is_boundary = boundary_points(edges, mesh.points.size());
  periost::Progress progress(context, "smooth", options.iterations);
  for (std::uint32_t i = 0; i < options.iterations; ++i) {
    step(result.points, unique, is_boundary, options.smoothing);
    step(result.points, unique, is_boundary, -options.inflation);
    progress.step();
  }
  return result;
}

}  // namespace smoothing_example
