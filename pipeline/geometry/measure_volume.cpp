#include "pipeline/geometry/measure_volume.h"

#include <fmt/format.h>

#include <array>
#include <functional>

#include "pipeline/base/parallel.h"
#include "pipeline/geometry/distribution.h"
#include "pipeline/geometry/extremes.h"
#include "pipeline/geometry/tet_quality.h"
#include "pipeline/geometry/tet_topology.h"

namespace periost {
namespace {

constexpr std::size_t kTetsPerTask = 8192;

// Says which part of the mesh a tetrahedron belongs to, for the worst elements.
class Describer {
 public:
  Describer(const TetMesh& mesh, const std::vector<Triangle>& boundary)
      : mesh_(mesh), on_boundary_(mesh.points.size(), false) {
    for (const Triangle& t : boundary) {
      for (const Index corner : t) on_boundary_[corner] = true;
    }
  }
  Vec3 centre(std::size_t t) const {
    const TetCorners c = tet_corners(mesh_, t);
    return (c[0] + c[1] + c[2] + c[3]) / 4;
  }
  std::vector<WorstElement> take(Extremes& extremes) const {
    std::vector<WorstElement> worst = extremes.take();
    for (WorstElement& element : worst) {
      int corners = 0;
      for (const Index corner : mesh_.tets[element.element]) corners += on_boundary_[corner] ? 1 : 0;
      element.origin = corners == 0 ? std::string("inside the volume")
                                    : fmt::format("{} of its 4 corners on the surface", corners);
    }
    return worst;
  }

 private:
  const TetMesh& mesh_;
  std::vector<bool> on_boundary_;
};

// One metric per tetrahedron: where it goes, which end is bad, how it is computed.
struct Row {
  const char* path;
  Extremes::Side bad;
  Distribution VolumeQuality::*member;
  double (*metric)(const TetCorners&);
};
constexpr std::array<Row, 6> kRows{
    {{"volume.min_dihedral_deg", Extremes::Side::kLowest, &VolumeQuality::min_dihedral_deg,
      [](const TetCorners& t) { return tet_dihedral_range(t).min_deg; }},
     {"volume.max_dihedral_deg", Extremes::Side::kHighest, &VolumeQuality::max_dihedral_deg,
      [](const TetCorners& t) { return tet_dihedral_range(t).max_deg; }},
     {"volume.radius_ratio", Extremes::Side::kHighest, &VolumeQuality::radius_ratio, tet_radius_ratio},
     {"volume.scaled_jacobian", Extremes::Side::kLowest, &VolumeQuality::scaled_jacobian,
      tet_scaled_jacobian},
     {"volume.mean_ratio", Extremes::Side::kLowest, &VolumeQuality::mean_ratio, tet_mean_ratio},
     {"volume.aspect_ratio", Extremes::Side::kHighest, &VolumeQuality::aspect_ratio, tet_aspect_ratio}}};

std::vector<double> per_tet(const TetMesh& mesh, const Context& context,
                            const std::function<double(std::size_t)>& metric) {
  std::vector<double> values(mesh.tets.size());
  parallel_blocks(context, values.size(), kTetsPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) values[t] = metric(t);
  });
  return values;
}

std::vector<WorstElement> worst_tets(const std::vector<double>& values, Extremes::Side bad,
                                     const Describer& describer) {
  Extremes extremes(bad);
  for (std::size_t t = 0; t < values.size(); ++t) extremes.add(t, values[t], describer.centre(t));
  return describer.take(extremes);
}

void measure_size_ratios(const std::vector<TetPair>& pairs, const std::vector<double>& volumes,
                         const Describer& describer, VolumeQuality& quality, WorstElements& worst) {
  std::vector<double> ratios;
  ratios.reserve(pairs.size());
  Extremes extremes(Extremes::Side::kHighest);
  for (const TetPair& pair : pairs) {
    ratios.push_back(tet_size_ratio(volumes[pair.first], volumes[pair.second]));
    extremes.add(pair.first, ratios.back(), describer.centre(pair.first));
  }
  worst["volume.size_ratio"] = describer.take(extremes);
  quality.size_ratio = distribution_of(std::move(ratios));
}

void count_inverted(const TetMesh& mesh, const std::vector<double>& volumes, const Describer& describer,
                    VolumeQuality& quality, WorstElements& worst) {
  Extremes extremes(Extremes::Side::kLowest);
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    double least = volumes[t];
    if (mesh.order() == 2) least = std::min(least, tet10_min_corner_jacobian(tet10_nodes(mesh, t)) / 6);
    if (least > 0) continue;
    ++quality.inverted;
    extremes.add(t, least, describer.centre(t));
  }
  if (quality.inverted > 0) worst["volume.inverted"] = describer.take(extremes);
}

}  // namespace

VolumeQuality measure_volume(const TetMesh& mesh, const Context& context, WorstElements& worst) {
  VolumeQuality quality;
  quality.tets = mesh.tets.size();
  quality.points = mesh.points.size();
  quality.order = mesh.order();
  quality.boundary_preserved = mesh.boundary_preserved;
  const TetFaces faces = tet_faces(mesh.tets, mesh.points.size());
  const Describer describer(mesh, mesh.boundary.empty() ? faces.boundary : mesh.boundary);

  const std::vector<double> volumes =
      per_tet(mesh, context, [&](std::size_t t) { return tet_volume(tet_corners(mesh, t)); });
  for (const double volume : volumes) quality.volume_mm3 += volume;
  count_inverted(mesh, volumes, describer, quality, worst);
  measure_size_ratios(faces.interior, volumes, describer, quality, worst);
  for (const Row& row : kRows) {
    std::vector<double> values =
        per_tet(mesh, context, [&](std::size_t t) { return row.metric(tet_corners(mesh, t)); });
    worst[row.path] = worst_tets(values, row.bad, describer);
    quality.*row.member = distribution_of(std::move(values));
  }
  if (mesh.order() == 2) {
    std::vector<double> values =
        per_tet(mesh, context, [&](std::size_t t) { return tet10_jacobian_ratio(tet10_nodes(mesh, t)); });
    worst["volume.jacobian_ratio"] = worst_tets(values, Extremes::Side::kLowest, describer);
    quality.jacobian_ratio = distribution_of(std::move(values));
  }
  return quality;
}

SurfaceMesh boundary_surface(const TetMesh& mesh) {
  SurfaceMesh surface;
  surface.points = mesh.points;
  surface.triangles =
      mesh.boundary.empty() ? tet_faces(mesh.tets, mesh.points.size()).boundary : mesh.boundary;
  surface.voxel_mm = mesh.voxel_mm;
  return surface;
}

}  // namespace periost
