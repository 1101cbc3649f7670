#pragma once
// Whether a mesh is fit for mechanics: looked at as a solver would, with the program's own linear-elastic
// elements. Patch test (patch_test.h), motions without energy (rigid_modes.h), conditioning relative to ideal
// elements (conditioning.h); docs/quality.md, section Mechanics.
#include <optional>

#include "pipeline/base/context.h"
#include "pipeline/data/quality_report.h"
#include "pipeline/data/tet_mesh.h"
#include "pipeline/geometry/measure_quality.h"

namespace periost {

// The measures, and the elements that limit `mechanics.condition_ratio` among the worst. Empty, with a
// warning in the log that says why, where there is nothing to measure ("mechanics.folded": an element without
// positive Jacobian, on which every solver stops; "mechanics.too_large": the matrix would take more than 4
// GiB, or more than half of the memory budget) and, without a warning, for a mesh without tetrahedra.
//
// The same bits for any number of threads. Time on one thread for 50,000 tetrahedra: about a second at first
// order, and twenty at second on a busy machine. Memory: the matrix's (stiffness.h). Precondition: indices
// valid, points finite.
std::optional<MechanicsQuality> measure_fitness(const TetMesh& mesh, const Context& context,
                                                WorstElements& worst);

}  // namespace periost
