#include "pipeline/mechanics/fitness.h"

#include <fmt/format.h>

#include <algorithm>

#include "pipeline/geometry/extremes.h"
#include "pipeline/mechanics/conditioning.h"
#include "pipeline/mechanics/patch_test.h"
#include "pipeline/mechanics/rigid_modes.h"

namespace periost {
namespace {

constexpr std::uint64_t kLargestMatrix = std::uint64_t{4} << 30;

Vec3 centre_of(const TetMesh& mesh, std::size_t t) {
  const auto& [a, b, c, d] = mesh.tets[t];
  return (mesh.points[a] + mesh.points[b] + mesh.points[c] + mesh.points[d]) / 4;
}

// Whether the matrix fits; by the usual number of blocks a point.
bool fits(const TetMesh& mesh, const Context& context) {
  const std::uint64_t blocks_per_point = mesh.order() == 2 ? 28 : 15;
  const std::uint64_t bytes = mesh.points.size() * blocks_per_point * (sizeof(Block) + sizeof(Index));
  const std::uint64_t limit =
      context.memory_bytes > 0 ? std::min(kLargestMatrix, context.memory_bytes / 2) : kLargestMatrix;
  if (bytes <= limit) return true;
  context.warn("mechanics.too_large",
               fmt::format("mechanics is not measured: the matrix of {} nodes would take {:.1f} GiB",
                           mesh.points.size(), static_cast<double>(bytes) / (1 << 30)));
  return false;
}

bool is_whole(const TetMesh& mesh, const Context& context) {
  const std::vector<std::size_t> folded = folded_tets(mesh, context);
  if (folded.empty()) return true;
  const Vec3 centre = centre_of(mesh, folded.front());
  context.warn("mechanics.folded",
               fmt::format("mechanics is not measured: {} elements have no positive Jacobian, the first of "
                           "them element {} at ({:.2f}, {:.2f}, {:.2f}) mm",
                           folded.size(), folded.front(), centre.x, centre.y, centre.z));
  return false;
}

}  // namespace

std::optional<MechanicsQuality> measure_fitness(const TetMesh& mesh, const Context& context,
                                                WorstElements& worst) {
  if (mesh.tets.empty() || !fits(mesh, context) || !is_whole(mesh, context)) return std::nullopt;
  const Material material;
  Stiffness stiffness = assemble_stiffness(mesh, material, context);
  const RigidModes modes = rigid_modes(mesh, stiffness, context);
  const PatchTest patch = patch_test(mesh, stiffness, context);
  const Conditioning condition = conditioning(mesh, material, stiffness, context);

  MechanicsQuality quality;
  quality.patch_test_error = patch.error;
  // Bodies apart are supported apart: only what more than one rigid motion each allows is a fault.
  quality.rigid_modes = modes.count + 6 - 6 * modes.bodies;
  quality.rigid_mode_error = modes.error;
  const auto& ratios = condition.eigenvalue_ratio;
  quality.condition_ratio = *std::max_element(ratios.begin(), ratios.end());
  quality.cg_iterations = condition.iterations;
  quality.cg_ratio =
      static_cast<double>(condition.iterations) / static_cast<double>(condition.ideal_iterations);
  Extremes extremes(Extremes::Side::kHighest);
  for (std::size_t t = 0; t < ratios.size(); ++t) extremes.add(t, ratios[t], centre_of(mesh, t));
  worst["mechanics.condition_ratio"] = extremes.take();
  return quality;
}

}  // namespace periost
