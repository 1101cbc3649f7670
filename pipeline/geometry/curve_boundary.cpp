#include "pipeline/geometry/curve_boundary.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <tuple>
#include <vector>

#include "pipeline/base/error.h"
#include "pipeline/geometry/isosurface_query.h"
#include "pipeline/geometry/tet_faces.h"
#include "pipeline/geometry/tet_quality.h"

namespace periost {
namespace {

// An edge of the boundary with its mid-side node and the sum of its triangles' unit normals.
struct BoundaryEdge {
  Index a = 0, b = 0;  // a < b
  Index node = kNoIndex;
  Vec3 normal;
};

bool is_before(const BoundaryEdge& s, const BoundaryEdge& t) {
  return s.a != t.a ? s.a < t.a : s.b < t.b;
}

// By ascending ends, each once.
std::vector<BoundaryEdge> boundary_edges(const TetMesh& mesh) {
  std::vector<BoundaryEdge> all;
  all.reserve(3 * mesh.boundary.size());
  for (const auto& [a, b, c] : mesh.boundary) {
    const Vec3 normal = normalized(cross(mesh.points[b] - mesh.points[a], mesh.points[c] - mesh.points[a]));
    for (const auto& [p, q] : {std::minmax(a, b), std::minmax(b, c), std::minmax(c, a)}) {
      all.push_back({p, q, kNoIndex, normal});
    }
  }
  std::stable_sort(all.begin(), all.end(), is_before);
  std::vector<BoundaryEdge> edges;
  for (const BoundaryEdge& edge : all) {
    if (!edges.empty() && !is_before(edges.back(), edge)) {
      edges.back().normal += edge.normal;
    } else {
      edges.push_back(edge);
    }
  }
  return edges;
}

void find_nodes(const TetMesh& mesh, std::vector<BoundaryEdge>& edges) {
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    for (std::size_t k = 0; k < 6; ++k) {
      BoundaryEdge sought;
      std::tie(sought.a, sought.b) = std::minmax(mesh.tets[t][static_cast<std::size_t>(kTetEdge[k][0])],
                                                 mesh.tets[t][static_cast<std::size_t>(kTetEdge[k][1])]);
      const auto found = std::lower_bound(edges.begin(), edges.end(), sought, is_before);
      if (found != edges.end() && !is_before(sought, *found)) found->node = mesh.midside[t][k];
    }
  }
}

// The tetrahedra around each mid-side node: those of node n are tets[first[n]] to tets[first[n + 1] - 1].
struct TetsOfNode {
  std::vector<std::size_t> first;
  std::vector<Index> tets;
};

TetsOfNode tets_of_nodes(const TetMesh& mesh) {
  TetsOfNode around;
  around.first.assign(mesh.points.size() + 1, 0);
  for (const MidsideNodes& nodes : mesh.midside) {
    for (const Index node : nodes) ++around.first[node + 1];
  }
  for (std::size_t n = 0; n < mesh.points.size(); ++n) around.first[n + 1] += around.first[n];
  around.tets.resize(6 * mesh.midside.size());
  std::vector<std::size_t> next(around.first.begin(), around.first.end() - 1);
  for (Index t = 0; t < mesh.midside.size(); ++t) {
    for (const Index node : mesh.midside[t]) around.tets[next[node]++] = t;
  }
  return around;
}

bool all_keep(const TetMesh& mesh, const TetsOfNode& around, Index node, double limit) {
  return std::all_of(around.tets.begin() + static_cast<std::ptrdiff_t>(around.first[node]),
                     around.tets.begin() + static_cast<std::ptrdiff_t>(around.first[node + 1]),
                     [&](Index t) { return tet10_jacobian_ratio(tet10_nodes(mesh, t)) >= limit; });
}

}  // namespace

CurveReport curve_boundary(TetMesh& mesh, const Isosurface& isosurface, const CurveOptions& options,
                           const Context& context) {
  PERIOST_ASSERT(mesh.order() == 2);
  std::vector<BoundaryEdge> edges = boundary_edges(mesh);
  find_nodes(mesh, edges);
  std::sort(edges.begin(), edges.end(),
            [](const BoundaryEdge& s, const BoundaryEdge& t) { return s.node < t.node; });
  const TetsOfNode around = tets_of_nodes(mesh);
  CurveReport report;
  for (const BoundaryEdge& edge : edges) {
    if (edge.node == kNoIndex) continue;
    if (++report.nodes % 4096 == 0) context.check_cancelled();
    const double length = norm(edge.normal);
    const Vec3 before = mesh.points[edge.node];
    const auto target = length > 0
                            ? closest_along_line(isosurface, before, edge.normal / length,
                                                 0.5 * distance(mesh.points[edge.a], mesh.points[edge.b]))
                            : std::nullopt;
    if (!target) {
      ++report.unseen;
      continue;
    }
    mesh.points[edge.node] = target->point;
    if (all_keep(mesh, around, edge.node, options.min_jacobian_ratio)) {
      ++report.moved;
      report.mean_before_mm += target->distance;
    } else {
      ++report.unsuitable;
      mesh.points[edge.node] = before;
    }
  }
  if (report.moved > 0) report.mean_before_mm /= static_cast<double>(report.moved);
  return report;
}

CurveReport curve_boundary_and_log(TetMesh& mesh, const Isosurface& isosurface, const CurveOptions& options,
                                   const char* code, const Context& context) {
  if (!isosurface.has_voxels()) {
    throw Error(
        ErrorKind::kUsage, code,
        "curved: true looks for the isosurface in an image's voxels, but no image is behind the surface",
        "leave out curved");
  }
  const CurveReport report = curve_boundary(mesh, isosurface, options, context);
  context.info(
      code,
      fmt::format("{} of {} mid-side nodes of the boundary moved onto the isosurface, by {:.3f} mm on "
                  "average; {} left straight for a Jacobian below {}, {} with no isosurface before them",
                  report.moved, report.nodes, report.mean_before_mm, report.unsuitable,
                  options.min_jacobian_ratio, report.unseen));
  return report;
}

}  // namespace periost
