#pragma once
// What both solvers share: unknowns as one flat vector, three numbers a node.
#include <vector>

#include "pipeline/mechanics/solver.h"

namespace periost {

struct FlatProblem {
  std::vector<double> force;         // loads
  std::vector<double> displacement;  // what is prescribed, 0 elsewhere
  std::vector<bool> is_free;         // neither supported nor without a tetrahedron
};

FlatProblem flatten(const Stiffness& stiffness, const LoadCase& load_case);

// Displacement, reactions and energy for the solved flat displacements.
Solution solution_of(const Stiffness& stiffness, const FlatProblem& problem, const Context& context);

}  // namespace periost
