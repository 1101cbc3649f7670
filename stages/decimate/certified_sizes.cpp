#include "stages/decimate/certified_sizes.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pipeline/base/parallel.h"
#include "pipeline/geometry/isosurface_query.h"

namespace periost {
namespace {

constexpr float kNoLimit = std::numeric_limits<float>::max();
constexpr double kThickVoxels = 20;  // sheets further apart than this are not thin
constexpr double kOff = 1e-6;        // voxels off a triangle, where the search for the next sheet begins
constexpr std::size_t kTrianglesPerTask = 4096;
constexpr double kSizeSlack = 1e-9;  // sums that differ by rounding count as equal

// Distance from a triangle to the next sheet that faces the other way; nothing when it is not thin there.
std::optional<double> thickness_at(const Isosurface& isosurface, Vec3 centroid, Vec3 normal, double voxel) {
  double least = kThickVoxels * voxel;
  bool is_thin = false;
  for (const double side : {1.0, -1.0}) {
    const auto hit =
        closest_along_line(isosurface, centroid + normal * (side * kOff * voxel), -normal, least);
    if (!hit) continue;
    least = std::min(least, hit->distance);
    is_thin = true;
  }
  return is_thin ? std::optional(least) : std::nullopt;
}

double excess_of_edges(const SizeLimits& limits, const std::array<Vec3, 3>& c,
                       const std::array<Index, 3>& near) {
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t a = (k + 1) % 3, b = (k + 2) % 3;
    const float limit = std::min(limits.longest_edge[near[a]], limits.longest_edge[near[b]]);
    sum += std::max(0.0, distance(c[a], c[b]) - static_cast<double>(limit));
  }
  return sum;
}

double longest_side(const std::array<Vec3, 3>& c) {
  return std::max({distance(c[0], c[1]), distance(c[1], c[2]), distance(c[2], c[0])});
}

double excess_of_ratio(double a, double b, double grading) {
  return std::max(0.0, std::max(a, b) / std::min(a, b) - grading);
}

bool meets_longest_edge(const SizeLimits& limits, const CertifiedMesh& mesh, const Proposal& proposal) {
  double before = 0, after = 0;
  for (const LinkedTriangle& cell : proposal.cells) {
    after +=
        excess_of_edges(limits, corners_after(mesh, proposal, cell),
                        {proposal.nearest_of(mesh, cell.corner[0]), proposal.nearest_of(mesh, cell.corner[1]),
                         proposal.nearest_of(mesh, cell.corner[2])});
  }
  if (after == 0) return true;
  for (const Index t : proposal.before) {
    const auto& c = mesh.triangles[t].corner;
    before += excess_of_edges(limits, corners_now(mesh, t),
                              {mesh.nearest[c[0]], mesh.nearest[c[1]], mesh.nearest[c[2]]});
  }
  return after <= before + kSizeSlack;
}

bool meets_grading(const SizeLimits& limits, const CertifiedMesh& mesh, const Proposal& proposal) {
  double before = 0, after = 0;
  for (const LinkedTriangle& cell : proposal.cells) {
    const double size = longest_side(corners_after(mesh, proposal, cell));
    for (const Index t : cell.across) {
      if (t == kNoIndex) continue;
      const LinkedTriangle& other = proposal.cell_of(mesh, t);
      after += excess_of_ratio(size, longest_side(corners_after(mesh, proposal, other)), limits.grading);
    }
  }
  if (after == 0) return true;
  for (const Index t : proposal.before) {
    const double size = longest_side(corners_now(mesh, t));
    for (const Index other : mesh.triangles[t].across) {
      if (other != kNoIndex)
        before += excess_of_ratio(size, longest_side(corners_now(mesh, other)), limits.grading);
    }
  }
  return after <= before + kSizeSlack;
}

}  // namespace

SizeLimits make_size_limits(const Isosurface& isosurface, const Reference& reference,
                            const DecimateOptions& options, const Context& context) {
  SizeLimits limits;
  limits.grading = options.grading;
  const double voxel = isosurface.frame.largest_spacing();
  if (!(options.max_edge.value > 0) && !(options.edge_per_thickness > 0) && options.refine.empty())
    return limits;
  limits.longest_edge.assign(reference.triangles.size(), kNoLimit);
  const double everywhere =
      options.max_edge.value > 0 ? options.max_edge.in_mm(voxel) : static_cast<double>(kNoLimit);
  parallel_blocks(
      context, reference.triangles.size(), kTrianglesPerTask, [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t) {
          const auto c = reference.corners(static_cast<Index>(t));
          const Vec3 centroid = (c[0] + c[1] + c[2]) / 3;
          double limit = everywhere;
          for (const EdgeLimit& place : options.refine) {
            if (distance(centroid, place.point) <= place.radius)
              limit = std::min(limit, place.max_edge.in_mm(voxel));
          }
          if (options.edge_per_thickness > 0) {
            const auto thickness = thickness_at(isosurface, centroid, reference.normals[t], voxel);
            if (thickness) limit = std::min(limit, options.edge_per_thickness * *thickness);
          }
          limits.longest_edge[t] = static_cast<float>(limit);
        }
      });
  return limits;
}

bool meets_sizes(const SizeLimits& limits, const CertifiedMesh& mesh, const Proposal& proposal) {
  return (limits.longest_edge.empty() || meets_longest_edge(limits, mesh, proposal)) &&
         (!(limits.grading > 0) || meets_grading(limits, mesh, proposal));
}

}  // namespace periost
