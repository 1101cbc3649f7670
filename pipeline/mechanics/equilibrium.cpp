#include "pipeline/mechanics/equilibrium.h"

#include "pipeline/base/error.h"

namespace periost {

FlatProblem flatten(const Stiffness& stiffness, const LoadCase& load_case) {
  const std::size_t unknowns = 3 * stiffness.nodes();
  FlatProblem problem{std::vector<double>(unknowns), std::vector<double>(unknowns),
                      std::vector<bool>(unknowns)};
  for (std::size_t k = 0; k < unknowns; ++k) problem.is_free[k] = stiffness.is_used(k / 3);
  for (const NodalLoad& load : load_case.loads) {
    for (std::size_t axis = 0; axis < 3; ++axis)
      problem.force[3 * std::size_t{load.node} + axis] += load.force[axis];
  }
  for (const Support& support : load_case.supports) {
    PERIOST_ASSERT(support.node < stiffness.nodes() && support.axis >= 0 && support.axis < 3);
    const std::size_t k = 3 * std::size_t{support.node} + static_cast<std::size_t>(support.axis);
    problem.is_free[k] = false;
    problem.displacement[k] = stiffness.is_used(support.node) ? support.displacement : 0;
  }
  return problem;
}

Solution solution_of(const Stiffness& stiffness, const FlatProblem& problem, const Context& context) {
  Solution solution;
  const std::size_t nodes = stiffness.nodes();
  solution.displacement.resize(nodes);
  solution.reaction.resize(nodes);
  std::vector<double> internal(3 * nodes);
  multiply(stiffness, problem.displacement, internal, context);
  double work = 0;
  for (std::size_t k = 0; k < 3 * nodes; ++k) {
    solution.displacement[k / 3][k % 3] = problem.displacement[k];
    if (!problem.is_free[k] && stiffness.is_used(k / 3)) {
      solution.reaction[k / 3][k % 3] = internal[k] - problem.force[k];
    }
    work += problem.displacement[k] * internal[k];
  }
  solution.energy = work / 2;
  return solution;
}

}  // namespace periost
