// The one table of metrics: what quality.json holds, path by path.
#include <algorithm>

#include "pipeline/base/diagnostic.h"
#include "pipeline/geometry/gates.h"

namespace periost {
namespace {

using Value = std::optional<double>;

// Paths of optional sections give nothing when the section is absent.
template <class Member>
std::function<Value(const QualityReport&)> in_surface(Member SurfaceQuality::*member) {
  return [member](const QualityReport& r) {
    return r.surface ? Value(static_cast<double>((*r.surface).*member)) : Value();
  };
}
template <class T>
std::function<Value(const QualityReport&)> in_surface(std::optional<T> SurfaceQuality::*member) {
  return [member](const QualityReport& r) {
    if (!r.surface || !((*r.surface).*member)) return Value();
    return Value(static_cast<double>(*((*r.surface).*member)));
  };
}
template <class Member>
std::function<Value(const QualityReport&)> in_volume(Member VolumeQuality::*member) {
  return [member](const QualityReport& r) {
    return r.volume ? Value(static_cast<double>((*r.volume).*member)) : Value();
  };
}
template <class T>
std::function<Value(const QualityReport&)> in_volume(std::optional<T> VolumeQuality::*member) {
  return [member](const QualityReport& r) {
    if (!r.volume || !((*r.volume).*member)) return Value();
    return Value(static_cast<double>(*((*r.volume).*member)));
  };
}
template <class Member>
std::function<Value(const QualityReport&)> in_mechanics(Member MechanicsQuality::*member) {
  return [member](const QualityReport& r) {
    return r.mechanics ? Value(static_cast<double>((*r.mechanics).*member)) : Value();
  };
}
template <class Member>
std::function<Value(const QualityReport&)> in_reference(Member ReferenceQuality::*member) {
  return [member](const QualityReport& r) {
    return r.mechanics && r.mechanics->reference
               ? Value(static_cast<double>((*r.mechanics->reference).*member))
               : Value();
  };
}
// Linear tetrahedra show their own stiffness beside the body's.
bool is_reference_of_second_order(const QualityReport& r) {
  return r.mechanics && r.mechanics->reference && r.mechanics->reference->order == 2;
}
std::function<Value(const QualityReport&)> in_distance(Value (*get)(const SurfaceDistance&)) {
  return [get](const QualityReport& r) {
    return r.surface && r.surface->distance ? get(*r.surface->distance) : Value();
  };
}

struct Word {
  const char* name;
  double Distribution::*member;
};
constexpr Word kWords[] = {{"min", &Distribution::min}, {"p01", &Distribution::p01},
                           {"p05", &Distribution::p05}, {"p50", &Distribution::p50},
                           {"p95", &Distribution::p95}, {"p99", &Distribution::p99},
                           {"max", &Distribution::max}, {"mean", &Distribution::mean}};

using GetDistribution = std::function<const Distribution*(const QualityReport&)>;

void add_distribution(std::vector<Metric>& table, const std::string& path, const char* unit, const char* op,
                      const char* doc, const GetDistribution& get) {
  for (const Word& word : kWords) {
    table.push_back({path + "." + word.name, unit, op, doc, [get, word](const QualityReport& r) {
                       const Distribution* d = get(r);
                       return d != nullptr && d->count > 0 ? Value(d->*word.member) : Value();
                     }});
  }
}
GetDistribution of_surface(Distribution SurfaceQuality::*member) {
  return [member](const QualityReport& r) { return r.surface ? &((*r.surface).*member) : nullptr; };
}
GetDistribution of_volume(Distribution VolumeQuality::*member) {
  return [member](const QualityReport& r) { return r.volume ? &((*r.volume).*member) : nullptr; };
}

void add_surface(std::vector<Metric>& t) {
  using S = SurfaceQuality;
  t.push_back({"surface.triangles", "", "<=", "Number of triangles.", in_surface(&S::triangles)});
  t.push_back(
      {"surface.vertices", "", "<=", "Number of points that a triangle uses.", in_surface(&S::vertices)});
  t.push_back(
      {"surface.components", "", "==", "Number of parts joined across edges.", in_surface(&S::components)});
  t.push_back(
      {"surface.euler", "", "==", "Vertices - edges + triangles: 2 for a sphere.", in_surface(&S::euler)});
  t.push_back({"surface.closed", "", "==", "No edge has only one triangle.", in_surface(&S::closed)});
  t.push_back(
      {"surface.manifold", "", "==",
       "No edge has more than two triangles, no vertex more than one fan, no triangle two equal corners.",
       in_surface(&S::manifold)});
  t.push_back({"surface.oriented", "", "==", "Neighbours run along their edge in opposite directions.",
               in_surface(&S::oriented)});
  t.push_back({"surface.same_topology", "", "==", "Components and Euler number are those of the isosurface.",
               in_surface(&S::same_topology)});
  t.push_back({"surface.self_intersections", "", "<=",
               "Pairs of triangles that meet elsewhere than in shared corners and edges, decided exactly.",
               in_surface(&S::self_intersections)});
  t.push_back({"surface.area_mm2", "mm^2", "<=", "Area.", in_surface(&S::area_mm2)});
  t.push_back({"surface.volume_mm3", "mm^3",
               "<=", "Enclosed volume of a closed surface, by the divergence theorem.",
               in_surface(&S::volume_mm3)});
  add_distribution(t, "surface.min_angle_deg", "deg", ">=",
                   "Smallest angle of a triangle, atan2(|u x v|, u . v) at each corner; 0..60, ideal 60.",
                   of_surface(&S::min_angle_deg));
  t.push_back({"surface.share_below_20deg", "", "<=", "Share of triangles with an angle below 20 degrees.",
               in_surface(&S::share_below_20deg)});
  t.push_back({"surface.share_below_30deg", "", "<=", "Share of triangles with an angle below 30 degrees.",
               in_surface(&S::share_below_30deg)});
  add_distribution(t, "surface.radius_ratio", "",
                   "<=", "R / (2 r) of a triangle, circumradius to inradius; 1..1e30, ideal 1.",
                   of_surface(&S::radius_ratio));
  t.push_back({"surface.valence_5_to_7", "", ">=", "Share of inner vertices with five to seven edges.",
               in_surface(&S::valence_5_to_7)});
}

void add_distance(std::vector<Metric>& t) {
  struct DistanceRow {
    const char* path;
    const char* doc;
    Value (*get)(const SurfaceDistance&);
  };
  const DistanceRow rows[] = {
      {"surface_to_isosurface.max", "Largest distance of the surface to the isosurface.",
       [](const SurfaceDistance& d) { return Value(d.surface_to_isosurface.max); }},
      {"surface_to_isosurface.mean", "Mean distance over the area of the surface.",
       [](const SurfaceDistance& d) { return Value(d.surface_to_isosurface.mean); }},
      {"surface_to_isosurface.rms", "Root mean square distance over the area of the surface.",
       [](const SurfaceDistance& d) { return Value(d.surface_to_isosurface.rms); }},
      {"surface_to_isosurface.p99", "Distance that 99 % of the surface's area keeps.",
       [](const SurfaceDistance& d) { return Value(d.surface_to_isosurface.p99); }},
      {"isosurface_to_surface.max", "Largest distance of the isosurface to the surface.",
       [](const SurfaceDistance& d) { return Value(d.isosurface_to_surface.max); }},
      {"isosurface_to_surface.mean", "Mean distance over the area of the isosurface.",
       [](const SurfaceDistance& d) { return Value(d.isosurface_to_surface.mean); }},
      {"isosurface_to_surface.rms", "Root mean square distance over the area of the isosurface.",
       [](const SurfaceDistance& d) { return Value(d.isosurface_to_surface.rms); }},
      {"isosurface_to_surface.p99", "Distance that 99 % of the isosurface's area keeps.",
       [](const SurfaceDistance& d) { return Value(d.isosurface_to_surface.p99); }},
      {"hausdorff", "The larger of the two largest distances.",
       [](const SurfaceDistance& d) { return Value(d.hausdorff); }},
      {"requested", "Distance that decimate was asked to keep.",
       [](const SurfaceDistance& d) { return d.requested; }}};
  for (const DistanceRow& row : rows) {
    t.push_back({std::string("surface.distance.") + row.path, "voxel", "<=", row.doc, in_distance(row.get)});
  }
  t.push_back({"surface.distance.over_requested", "",
               "<=", "max(0, hausdorff / requested - 1): by which share the distance asked for is exceeded.",
               in_distance([](const SurfaceDistance& d) { return d.over_requested; })});
  using S = SurfaceQuality;
  t.push_back(
      {"surface.smoothness.simplex_angle_rms_deg", "deg", "<=",
       "Root mean square of phi - mean of phi over the three neighbours, phi the simplex angle of the dual "
       "mesh.",
       in_surface(&S::simplex_angle_rms_deg)});
  t.push_back({"surface.smoothness.normal_deviation_rms_deg", "deg",
               "<=", "Root mean square of the angle between normals across edges.",
               in_surface(&S::normal_deviation_rms_deg)});
  t.push_back({"surface.volume_change", "",
               "<=", "(V - V_iso) / V_iso of the enclosed volumes; a gate looks at its absolute value.",
               in_surface(&S::volume_change), true});
}

void add_volume(std::vector<Metric>& t) {
  using V = VolumeQuality;
  t.push_back({"volume.tets", "", "<=", "Number of tetrahedra.", in_volume(&V::tets)});
  t.push_back(
      {"volume.points", "", "<=", "Number of points, mid-side nodes included.", in_volume(&V::points)});
  t.push_back({"volume.order", "", "==", "1 or 2.", in_volume(&V::order)});
  t.push_back({"volume.inverted", "", "<=",
               "Tetrahedra whose volume, or at second order whose Jacobian at a corner, is not positive.",
               in_volume(&V::inverted)});
  t.push_back(
      {"volume.volume_mm3", "mm^3", "<=", "Sum of the tetrahedra's volumes.", in_volume(&V::volume_mm3)});
  add_distribution(t, "volume.min_dihedral_deg", "deg", ">=",
                   "Smallest angle between faces, pi - angle of the outward normals; 0..70.53, ideal 70.53.",
                   of_volume(&V::min_dihedral_deg));
  add_distribution(t, "volume.max_dihedral_deg", "deg",
                   "<=", "Largest angle between faces; 70.53..180, ideal 70.53.",
                   of_volume(&V::max_dihedral_deg));
  add_distribution(t, "volume.radius_ratio", "",
                   "<=", "R / (3 r), circumradius to inradius; 1..1e30, ideal 1.",
                   of_volume(&V::radius_ratio));
  add_distribution(t, "volume.scaled_jacobian", "",
                   ">=", "sqrt(2) 6 V / (largest product of the three edges at a corner); -1..1, ideal 1.",
                   of_volume(&V::scaled_jacobian));
  add_distribution(t, "volume.mean_ratio", "",
                   ">=", "Knupp's shape, 12 (3 V)^(2/3) / sum of squared edges; 0..1, ideal 1.",
                   of_volume(&V::mean_ratio));
  add_distribution(t, "volume.aspect_ratio", "", "<=", "Longest edge / (2 sqrt(6) r); 1..1e30, ideal 1.",
                   of_volume(&V::aspect_ratio));
  add_distribution(t, "volume.size_ratio", "", "<=",
                   "Larger to smaller cube root of the volumes of two tetrahedra that share a face; 1..1e30.",
                   of_volume(&V::size_ratio));
  add_distribution(
      t, "volume.jacobian_ratio", "", ">",
      "Second order: smallest J / largest |J| over corners, mid-side nodes and four Gauss points; -1..1, "
      "ideal 1.",
      [](const QualityReport& r) {
        return r.volume && r.volume->jacobian_ratio ? &*r.volume->jacobian_ratio : nullptr;
      });
  t.push_back({"volume.boundary_preserved", "", "==", "The mesher kept every triangle of the surface.",
               in_volume(&V::boundary_preserved)});
}

void add_mechanics(std::vector<Metric>& t) {
  using M = MechanicsQuality;
  t.push_back({"mechanics.patch_test_error", "", "<=",
               "Largest error of the nodes inside for a linear displacement of the boundary, to the "
               "largest displacement.",
               in_mechanics(&M::patch_test_error)});
  t.push_back({"mechanics.rigid_modes", "", "==",
               "Motions of a free body without energy, less 6 for each further body: 6 when all are whole.",
               in_mechanics(&M::rigid_modes)});
  t.push_back({"mechanics.rigid_mode_error", "", "<=",
               "Largest force at a node by a rigid motion, to what its row of the stiffness could hold.",
               in_mechanics(&M::rigid_mode_error)});
  t.push_back({"mechanics.condition_ratio", "", "<=",
               "Largest eigenvalue of an element's stiffness matrix, to that of the ideal element of the "
               "mean volume.",
               in_mechanics(&M::condition_ratio)});
  t.push_back({"mechanics.cg_iterations", "",
               "<=", "Iterations of conjugate gradients (Jacobi) for the body on an elastic bed.",
               in_mechanics(&M::cg_iterations)});
  t.push_back({"mechanics.cg_ratio", "",
               "<=", "These iterations to those of ideal elements of the mean volume.",
               in_mechanics(&M::cg_ratio)});
  using R = ReferenceQuality;
  t.push_back({"mechanics.reference.stiffness", "", "<=",
               "Stiffness when stretched, (mesh's - fine's) / fine's; a gate looks at its absolute value.",
               in_reference(&R::stiffness), true, is_reference_of_second_order});
  t.push_back({"mechanics.reference.energy", "",
               "<=", "Strain energy when stretched, (mesh's - fine's) / fine's, likewise.",
               in_reference(&R::energy), true, is_reference_of_second_order});
  t.push_back({"mechanics.reference.p95_von_mises", "", "<=",
               "95th percentile of the von Mises stress by volume, (mesh's - fine's) / fine's, likewise.",
               in_reference(&R::p95_von_mises), true, is_reference_of_second_order});
  t.push_back({"mechanics.reference.order", "", "==",
               "1 or 2: order of both meshes' elements when stretched; at 1 no gate judges the three above.",
               in_reference(&R::order)});
}

}  // namespace

const std::vector<Metric>& metrics() {
  static const std::vector<Metric> table = [] {
    std::vector<Metric> t;
    t.push_back(
        {"decimation.rate", "", ">=", "1 - triangles after / triangles before.",
         [](const QualityReport& r) { return r.decimation ? Value(r.decimation->rate()) : Value(); }});
    add_surface(t);
    add_distance(t);
    add_volume(t);
    add_mechanics(t);
    return t;
  }();
  return table;
}

const Metric* find_metric(const std::string& path) {
  const auto& table = metrics();
  const auto found =
      std::find_if(table.begin(), table.end(), [&](const Metric& metric) { return metric.path == path; });
  return found == table.end() ? nullptr : &*found;
}

std::string nearest_metric(const std::string& path) {
  std::vector<std::string> paths;
  for (const Metric& metric : metrics()) paths.push_back(metric.path);
  return nearest_name(path, paths);
}

}  // namespace periost
