#include <cmath>
#include <functional>
#include <optional>

#include "pipeline/base/parallel.h"
#include "pipeline/mechanics/coarse_space.h"
#include "pipeline/mechanics/equilibrium.h"

namespace periost {
namespace {

constexpr std::size_t kNumbersPerTask = 8192;

// Adds up body(begin, end) over blocks, in their order, whatever thread computed them.
double ordered_sum(const Context& context, std::size_t count,
                   const std::function<double(std::size_t, std::size_t)>& body) {
  std::vector<double> partial((count + kNumbersPerTask - 1) / kNumbersPerTask);
  parallel_blocks(context, count, kNumbersPerTask, [&](std::size_t begin, std::size_t end) {
    partial[begin / kNumbersPerTask] = body(begin, end);
  });
  double sum = 0;
  for (const double part : partial) sum += part;
  return sum;
}

// One over the diagonal; 0 for what is not free, which keeps it still without further care.
std::vector<double> inverse_diagonal(const Stiffness& stiffness, const std::vector<bool>& is_free) {
  std::vector<double> inverse(is_free.size());
  for (std::size_t k = 0; k < inverse.size(); ++k) {
    if (!is_free[k]) continue;
    const std::size_t block = stiffness.find(k / 3, static_cast<Index>(k / 3));
    inverse[k] = 1 / stiffness.blocks[block][4 * (k % 3)];
  }
  return inverse;
}

}  // namespace

Solution solve_iteratively(const Stiffness& stiffness, const LoadCase& load_case,
                           const IterativeOptions& options, const Context& context) {
  FlatProblem problem = flatten(stiffness, load_case);
  std::vector<double>& u = problem.displacement;
  const std::vector<double> inverse = inverse_diagonal(stiffness, problem.is_free);
  std::optional<CoarseSpace> coarse;
  if (!options.points.empty()) coarse.emplace(stiffness, problem.is_free, options.points, context);
  const std::size_t count = u.size();
  std::vector<double> residual(count), corrected(count), direction(count), product(count);
  // What the preconditioner makes of the residual; returns the square of the residual's norm in it.
  const auto precondition = [&] {
    parallel_blocks(context, count, kNumbersPerTask, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) corrected[k] = inverse[k] * residual[k];
    });
    if (coarse) coarse->add_motion(residual, corrected, context);
    return ordered_sum(context, count, [&](std::size_t begin, std::size_t end) {
      double sum = 0;
      for (std::size_t k = begin; k < end; ++k) sum += corrected[k] * residual[k];
      return sum;
    });
  };
  multiply(stiffness, u, product, context);
  for (std::size_t k = 0; k < count; ++k) residual[k] = problem.force[k] - product[k];
  double squared = precondition();
  direction = corrected;
  const double enough = options.tolerance * options.tolerance * squared;
  std::size_t iterations = 0;
  for (; squared > enough && iterations < options.max_iterations; ++iterations) {
    context.check_cancelled();
    multiply(stiffness, direction, product, context);
    const double curvature = ordered_sum(context, count, [&](std::size_t begin, std::size_t end) {
      double sum = 0;
      for (std::size_t k = begin; k < end; ++k) sum += direction[k] * product[k];
      return sum;
    });
    if (!(curvature > 0)) break;  // a free motion, or rounding at the end
    const double length = squared / curvature;
    parallel_blocks(context, count, kNumbersPerTask, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        u[k] += length * direction[k];
        residual[k] -= length * product[k];
      }
    });
    const double before = squared;
    squared = precondition();
    const double turn = squared / before;
    parallel_blocks(context, count, kNumbersPerTask, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) direction[k] = corrected[k] + turn * direction[k];
    });
  }
  Solution solution = solution_of(stiffness, problem, context);
  solution.iterations = iterations;
  solution.has_converged = squared <= enough;
  return solution;
}

}  // namespace periost
