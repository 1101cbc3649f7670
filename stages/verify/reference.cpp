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
constexpr const char* kOurs = "this mesh";
constexpr const char* kTheirs = "the undecimated mesh";

void leave_out(const Context& context, const char* code, const std::string& why) {
  context.warn(code, "the mesh is not compared with the undecimated one: " + why);
}

// The highest order at which both meshes fit, with a warning where that is the first; nothing, after a
// warning, where they fit at none.
std::optional<int> order_that_fits(const TetMesh& mesh, const TetMesh& fine, const Context& context) {
  const std::uint64_t limit =
      context.memory_bytes > 0 ? std::min(kLargest, context.memory_bytes / 2) : kLargest;
  const bool is_ours = mesh.tets.size() > fine.tets.size();
  const TetMesh& larger = is_ours ? mesh : fine;
  if (stretch_bytes(larger, 2) <= limit) return 2;
  const auto would_take = [&](int order) {
    return fmt::format("the {} tetrahedra of {} would take {:.3g} GiB at {} order", larger.tets.size(),
                       is_ours ? kOurs : kTheirs,
                       static_cast<double>(stretch_bytes(larger, order)) / (1 << 30),
                       order == 1 ? "first" : "second");
  };
  if (stretch_bytes(larger, 1) > limit) {
    leave_out(context, "mechanics.too_large", would_take(1));
    return std::nullopt;
  }
  context.warn("mechanics.first_order",
               fmt::format("the two meshes are compared at first order and no gate judges the differences, "
                           "since {}; they are the surface's only where elements are of about equal size, so "
                           "give both tetgen stages the same max_volume",
                           would_take(2)));
  return 1;
}

// The stretched mesh, or nothing after a warning. `name`: which of the two.
std::optional<Stretch> stretched(const TetMesh& mesh, const StretchFrame& frame, int order, const char* name,
                                 const Context& context) {
  if (const auto folded = folded_tets(mesh, context); !folded.empty()) {
    leave_out(context, "mechanics.folded",
              fmt::format("{} elements of {} have no positive Jacobian", folded.size(), name));
    return std::nullopt;
  }
  const auto start = Clock::now();
  const std::optional<Stretch> result = stretch(mesh, frame, Material{}, order, context);
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
  const auto order = order_that_fits(mesh, fine, context);
  const auto ours = order ? stretched(mesh, frame, *order, kOurs, context) : std::nullopt;
  const auto theirs = ours ? stretched(fine, frame, *order, kTheirs, context) : std::nullopt;
  if (!theirs) return std::nullopt;
  const auto difference = [](double a, double b) { return (a - b) / b; };
  ReferenceQuality quality;
  quality.stiffness = difference(ours->stiffness, theirs->stiffness);
  quality.energy = difference(ours->energy, theirs->energy);
  quality.p95_von_mises = difference(ours->p95_von_mises, theirs->p95_von_mises);
  quality.order = *order;
  quality.axis = std::string(1, "xyz"[frame.axis]);
  quality.mesh = quality_of(*ours);
  quality.fine = quality_of(*theirs);
  return quality;
}

}  // namespace periost
