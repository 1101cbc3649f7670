#pragma once
// Which earlier output feeds which input: the part of the plan that follows `from:` and the newest of each
// kind.
#include <vector>

#include "pipeline/run/plan.h"

namespace periost {

// The inputs of a stage that comes after `earlier`. An isosurface stands for a surface where `from:` names
// it; a surface for an isosurface where `from:` names it, or where no earlier stage makes one and the stage
// needs one or an earlier one was given that surface as its own. Inputs of kind hints are left out: they come
// from the round before (plan.h). Errors: plan.unknown_id, plan.later_id (a `from:` that names nobody, or a
// stage further down: `chain` holds all entries), plan.unknown_port, plan.kind_mismatch, plan.missing_input,
// plan.ambiguous_input (several inputs of a kind), plan.property (the producer does not guarantee what is
// required).
std::vector<PlanInput> connect(const StageEntry& entry, const StageDeclaration& declaration,
                               const std::vector<PlanStep>& earlier, const std::vector<StageEntry>& chain,
                               Diagnostics& diagnostics);

}  // namespace periost
