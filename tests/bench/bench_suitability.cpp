// Stretches tetrahedral meshes of one body in the frame of the first (pipeline/mechanics/stretch.h) and says
// what each answers, as one line of JSON a mesh:
//   bench_suitability [--threads N] FINE.vtu MESH.vtu...
// scripts/suitability.py runs it for the table in docs/suitability.md.
#include <chrono>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>
#include <variant>
#include <vector>

#include "pipeline/io/mesh_read.h"
#include "pipeline/mechanics/stiffness.h"
#include "pipeline/mechanics/stretch.h"

namespace {

using namespace periost;

nlohmann::ordered_json measure(const std::string& file, std::optional<StretchFrame>& frame,
                               const Context& context) {
  nlohmann::ordered_json said{{"file", file}};
  const AnyMesh read = read_mesh(file);
  const auto* mesh = std::get_if<TetMesh>(&read);
  if (mesh == nullptr) return said;
  if (!frame) frame = stretch_frame(*mesh);
  said["tets"] = mesh->tets.size();
  said["folded"] = folded_tets(*mesh, context).size();
  if (said["folded"] > 0) return said;
  const auto start = std::chrono::steady_clock::now();
  const auto result = stretch(*mesh, *frame, Material{}, context);
  if (!result) return said;
  said["seconds"] = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
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

}  // namespace

int main(int count, char** arguments) {
  Context context;
  std::optional<StretchFrame> frame;
  for (int i = 1; i < count; ++i) {
    const std::string argument = arguments[i];
    if (argument == "--threads" && i + 1 < count) {
      context.threads = std::stoi(arguments[++i]);
    } else {
      std::cout << measure(argument, frame, context).dump() << std::endl;
    }
  }
  return frame ? 0 : 2;
}
