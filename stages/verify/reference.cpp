#include "stages/verify/reference.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "pipeline/mechanics/stiffness.h"
#include "pipeline/mechanics/stretch.h"

namespace periost {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::uint64_t kLargest = std::uint64_t{8} << 30;

void leave_out(const Context& context, const char* code, const std::string& why) {
  context.warn(code, "the mesh is not compared with the undecimated one: " + why);
}

// The stretched mesh, or nothing after a warning. `name`: which of the two.
std::optional<Stretch> stretched(const TetMesh& mesh, const StretchFrame& frame, const char* name,
                                 const Context& context) {
  const std::uint64_t limit =
      context.memory_bytes > 0 ? std::min(kLargest, context.memory_bytes / 2) : kLargest;
  if (stretch_bytes(mesh) > limit) {
    leave_out(context, "mechanics.too_large",
              fmt::format("at second order the {} tetrahedra of {} would take {:.1f} GiB", mesh.tets.size(),
                          name, static_cast<double>(stretch_bytes(mesh)) / (1 << 30)));
    return std::nullopt;
  }
  if (const auto folded = folded_tets(mesh, context); !folded.empty()) {
    leave_out(context, "mechanics.folded",
              fmt::format("{} elements of {} have no positive Jacobian", folded.size(), name));
    return std::nullopt;
  }
  const auto start = Clock::now();
  const std::optional<Stretch> result = stretch(mesh, frame, Material{}, context);
  if (!result) {
    leave_out(context, "mechanics.not_spanned",
              fmt::format("no body of {} reaches from one end to the other", name));
    return std::nullopt;
  }
  if (!result->has_converged) {
    leave_out(context, "mechanics.not_converged",
              fmt::format("the solution of {} did not end in {} iterations", name, result->iterations));
    return std::nullopt;
  }
  context.info("mechanics.stretched",
               fmt::format("{}: {} tetrahedra, {} nodes, stiffness {:.6g} N/mm, energy {:.6g} N mm, 95 % of "
                           "the stress below {:.4g} MPa; {} bodies, {} left out; {} iterations, {:.1f} s",
                           name, result->tets, result->nodes, result->stiffness, result->energy,
                           result->p95_von_mises, result->bodies, result->left_out, result->iterations,
                           std::chrono::duration<double>(Clock::now() - start).count()));
  return result;
}

StretchQuality quality_of(const Stretch& s) {
  return {s.stiffness, s.energy, s.p95_von_mises, s.tets, s.nodes, s.iterations};
}

}  // namespace

std::optional<ReferenceQuality> compare_with_reference(const TetMesh& mesh, const TetMesh& fine,
                                                       const Context& context) {
  if (mesh.tets.empty() || fine.tets.empty()) {
    leave_out(context, "mechanics.not_spanned", "one of them has no tetrahedra");
    return std::nullopt;
  }
  const StretchFrame frame = stretch_frame(fine);
  const auto ours = stretched(mesh, frame, "this mesh", context);
  const auto theirs = ours ? stretched(fine, frame, "the undecimated mesh", context) : std::nullopt;
  if (!theirs) return std::nullopt;
  const auto difference = [](double a, double b) { return (a - b) / b; };
  ReferenceQuality quality;
  quality.stiffness = difference(ours->stiffness, theirs->stiffness);
  quality.energy = difference(ours->energy, theirs->energy);
  quality.p95_von_mises = difference(ours->p95_von_mises, theirs->p95_von_mises);
  quality.axis = std::string(1, "xyz"[frame.axis]);
  quality.mesh = quality_of(*ours);
  quality.fine = quality_of(*theirs);
  return quality;
}

}  // namespace periost
