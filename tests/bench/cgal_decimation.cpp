#include "tests/bench/cgal_decimation.h"

#include <stdexcept>

#ifdef PERIOST_BENCH_CGAL
#include <CGAL/Polygon_mesh_processing/remesh.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Count_ratio_stop_predicate.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/GarlandHeckbert_policies.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>

#include <chrono>
#include <cmath>

#include "pipeline/geometry/topology.h"
#endif

namespace periost {

#ifndef PERIOST_BENCH_CGAL

SurfaceMesh cgal_decimated(const SurfaceMesh& /*surface*/, CgalMethod /*method*/, std::size_t /*triangles*/,
                           double& /*seconds*/) {
  throw std::runtime_error("built without CGAL: configure with -DPERIOST_BENCH_CGAL=ON");
}

#else

namespace {

namespace Simplification = CGAL::Surface_mesh_simplification;
using Kernel = CGAL::Simple_cartesian<double>;
using CgalMesh = CGAL::Surface_mesh<Kernel::Point_3>;
using Clock = std::chrono::steady_clock;

CgalMesh to_cgal(const SurfaceMesh& surface) {
  CgalMesh mesh;
  for (const Vec3& p : surface.points) mesh.add_vertex({p.x, p.y, p.z});
  using Vertex = CgalMesh::Vertex_index;
  for (const auto& [a, b, c] : surface.triangles) {
    if (mesh.add_face(Vertex(a), Vertex(b), Vertex(c)) == CgalMesh::null_face()) {
      throw std::runtime_error("CGAL refuses a triangle of the surface");
    }
  }
  return mesh;
}

SurfaceMesh from_cgal(CgalMesh& mesh, double voxel_mm) {
  mesh.collect_garbage();
  SurfaceMesh surface;
  surface.voxel_mm = voxel_mm;
  for (const auto v : mesh.vertices()) {
    const auto& p = mesh.point(v);
    surface.points.push_back({p.x(), p.y(), p.z()});
  }
  for (const auto f : mesh.faces()) {
    Triangle triangle{};
    std::size_t k = 0;
    for (const auto v : vertices_around_face(mesh.halfedge(f), mesh))
      triangle[k++] = static_cast<Index>(v.idx());
    surface.triangles.push_back(triangle);
  }
  return surface;
}

// Edges of equilateral triangles that share the area evenly.
double edge_length(const SurfaceMesh& surface, std::size_t triangles) {
  return std::sqrt(surface_area(surface) / static_cast<double>(triangles) * 4 / std::sqrt(3.0));
}

}  // namespace

SurfaceMesh cgal_decimated(const SurfaceMesh& surface, CgalMethod method, std::size_t triangles,
                           double& seconds) {
  CgalMesh mesh = to_cgal(surface);
  const Simplification::Count_ratio_stop_predicate<CgalMesh> stop(
      static_cast<double>(triangles) / static_cast<double>(surface.triangles.size()));
  const auto start = Clock::now();
  if (method == CgalMethod::kLindstromTurk) {
    Simplification::edge_collapse(mesh, stop);
  } else if (method == CgalMethod::kGarlandHeckbert) {
    using Policies = Simplification::GarlandHeckbert_policies<CgalMesh, Kernel>;
    Policies policies(mesh);
    Simplification::edge_collapse(
        mesh, stop, CGAL::parameters::get_cost(policies.get_cost()).get_placement(policies.get_placement()));
  } else {
    CGAL::Polygon_mesh_processing::isotropic_remeshing(faces(mesh), edge_length(surface, triangles), mesh,
                                                       CGAL::parameters::number_of_iterations(3));
  }
  seconds = std::chrono::duration<double>(Clock::now() - start).count();
  return from_cgal(mesh, surface.voxel_mm);
}

#endif

}  // namespace periost
