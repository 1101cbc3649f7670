// Stretches tetrahedral meshes of one body in the frame of the first (pipeline/mechanics/stretch.h) and says
// what each answers, as one line of JSON a mesh:
//   bench_suitability [--threads N] [--order 1] FINE.vtu MESH.vtu...
//   bench_suitability [--threads N] [--order 1] --frame FINE.vtu MESH.vtu...       without FINE's own answer
// or decimates a surface by vtkQuadricDecimation to a number of triangles:
//   bench_suitability --quadric SURFACE.vtp TRIANGLES OUT.vtp
// scripts/suitability.py runs it for the table in docs/suitability.md.
#include <vtkNew.h>
#include <vtkPolyData.h>
#include <vtkQuadricDecimation.h>

#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "pipeline/geometry/tet_faces.h"
#include "pipeline/io/mesh_read.h"
#include "pipeline/io/surface_write.h"
#include "pipeline/mechanics/stiffness.h"
#include "pipeline/mechanics/stretch.h"
#include "pipeline/run/clock.h"
#include "tests/bench/vtk_surface.h"

namespace {

using namespace periost;

double volume_of(const TetMesh& mesh) {
  double volume = 0;
  for (const auto& [a, b, c, d] : mesh.tets) {
    volume += six_volumes(mesh.points[a], mesh.points[b], mesh.points[c], mesh.points[d]) / 6;
  }
  return volume;
}

nlohmann::ordered_json measure(const std::string& file, std::optional<StretchFrame>& frame, int order,
                               const Context& context) {
  nlohmann::ordered_json said{{"file", file}, {"order", order}};
  const AnyMesh read = read_mesh(file);
  const auto* mesh = std::get_if<TetMesh>(&read);
  if (mesh == nullptr) return said;
  if (!frame) frame = stretch_frame(*mesh);
  said["tets"] = mesh->tets.size();
  said["volume_mm3"] = volume_of(*mesh);
  said["folded"] = folded_tets(*mesh, context).size();
  if (said["folded"] > 0) return said;
  const auto start = Clock::now();
  const auto result = stretch(*mesh, *frame, Material{}, order, context);
  if (!result) return said;
  said["seconds"] = seconds_since(start);
  said["nodes"] = result->nodes;
  said["bodies"] = result->bodies;
  said["left_out"] = result->left_out;
  said["stiffness"] = result->stiffness;
  said["energy"] = result->energy;
  said["p95_von_mises"] = result->p95_von_mises;
  said["imbalance"] = result->imbalance;
  said["iterations"] = result->iterations;
  said["has_converged"] = result->has_converged;
  return said;
}

SurfaceMesh by_quadric(const SurfaceMesh& surface, std::size_t triangles) {
  vtkNew<vtkPolyData> data = to_vtk(surface);
  vtkNew<vtkQuadricDecimation> filter;
  filter->SetInputData(data);
  filter->SetTargetReduction(1 -
                             static_cast<double>(triangles) / static_cast<double>(surface.triangles.size()));
  filter->VolumePreservationOn();
  filter->Update();
  return from_vtk(filter->GetOutput(), surface.voxel_mm);
}

}  // namespace

int main(int count, char** arguments) {
  if (count == 5 && std::string(arguments[1]) == "--quadric") {
    const AnyMesh surface = read_mesh(arguments[2]);
    write_surface(by_quadric(std::get<SurfaceMesh>(surface), std::stoul(arguments[3])), arguments[4]);
    return 0;
  }
  Context context;
  int order = 2;
  std::optional<StretchFrame> frame;
  for (int i = 1; i < count; ++i) {
    const std::string argument = arguments[i];
    if (argument == "--threads" && i + 1 < count) {
      context.threads = std::stoi(arguments[++i]);
    } else if (argument == "--order" && i + 1 < count) {
      order = std::stoi(arguments[++i]);
    } else if (argument == "--frame" && i + 1 < count) {
      frame = stretch_frame(std::get<TetMesh>(read_mesh(arguments[++i])));
    } else {
      std::cout << measure(argument, frame, order, context).dump() << std::endl;
    }
  }
  return frame ? 0 : 2;
}
