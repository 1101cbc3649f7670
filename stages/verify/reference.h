#pragma once
// The direct measure of what decimation costs mechanics: the same load case on the chain's mesh and on a mesh
// of the undecimated isosurface (pipeline/mechanics/stretch.h).
#include <optional>

#include "pipeline/base/context.h"
#include "pipeline/data/quality_report.h"
#include "pipeline/data/tet_mesh.h"

namespace periost {

// Stretches both in the frame of the fine mesh, E = 17 GPa, nu = 0.3, of which only nu has an effect on the
// differences. Logs what each gave ("mechanics.stretched", with the seconds).
//
// Both at second order, where either takes no more than 8 GiB and half of the memory budget; else both at
// first order, with a warning ("mechanics.first_order"): linear tetrahedra add a stiffness of their own that
// grows with their size, so that the differences are the surface's only where the elements are about equal in
// size. ReferenceQuality::order says which, and no gate judges first order.
//
// Empty, with a warning that says why, where there is nothing to compare: an element folds
// ("mechanics.folded"), one of the meshes is too large at first order, too ("mechanics.too_large"), no body
// of one of them reaches from one end to the other ("mechanics.not_spanned"), or the solver did not end
// ("mechanics.not_converged"). The same bits for any number of threads.
std::optional<ReferenceQuality> compare_with_reference(const TetMesh& mesh, const TetMesh& fine,
                                                       const Context& context);

}  // namespace periost
