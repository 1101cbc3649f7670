#pragma once
// The direct measure of what decimation costs mechanics: the same load case on the chain's mesh and on a mesh
// of the undecimated isosurface (pipeline/mechanics/stretch.h).
#include <optional>

#include "pipeline/base/context.h"
#include "pipeline/data/quality_report.h"
#include "pipeline/data/tet_mesh.h"

namespace periost {

// Stretches both in the frame of the fine mesh, E = 17 GPa, nu = 0.3, of which only nu has an effect on the
// differences. Logs what each gave ("mechanics.stretched", with the seconds). Empty, with a warning that says
// why, where there is nothing to compare: an element folds ("mechanics.folded"), a solution would take more
// than 8 GiB or half of the memory budget ("mechanics.too_large"), no body of one of the meshes reaches from
// one end to the other ("mechanics.not_spanned"), or the solver did not end ("mechanics.not_converged").
// The same bits for any number of threads.
std::optional<ReferenceQuality> compare_with_reference(const TetMesh& mesh, const TetMesh& fine,
                                                       const Context& context);

}  // namespace periost
