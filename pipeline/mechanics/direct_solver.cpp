#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>

#include "pipeline/base/error.h"
#include "pipeline/mechanics/equilibrium.h"

namespace periost {
namespace {

using SparseMatrix = Eigen::SparseMatrix<double, Eigen::ColMajor, std::ptrdiff_t>;
using Factorisation = Eigen::SimplicialLDLT<SparseMatrix, Eigen::Lower, Eigen::AMDOrdering<std::ptrdiff_t>>;

constexpr std::ptrdiff_t kNone = -1;

// The number of each free unknown in the reduced matrix.
std::vector<std::ptrdiff_t> numbered(const std::vector<bool>& is_free) {
  std::vector<std::ptrdiff_t> number(is_free.size(), kNone);
  std::ptrdiff_t next = 0;
  for (std::size_t k = 0; k < is_free.size(); ++k) {
    if (is_free[k]) number[k] = next++;
  }
  return number;
}

// The lower half of K - shift diag(K), of the free unknowns alone.
SparseMatrix reduced(const Stiffness& stiffness, const std::vector<std::ptrdiff_t>& number,
                     std::ptrdiff_t unknowns, double shift) {
  SparseMatrix matrix(unknowns, unknowns);
  std::vector<Eigen::Triplet<double, std::ptrdiff_t>> entries;
  entries.reserve(5 * stiffness.blocks.size());
  for (std::size_t row = 0; row < stiffness.nodes(); ++row) {
    for (std::size_t b = stiffness.first[row]; b < stiffness.first[row + 1]; ++b) {
      for (std::size_t k = 0; k < 9; ++k) {
        const std::ptrdiff_t i = number[3 * row + k / 3];
        const std::ptrdiff_t j = number[3 * std::size_t{stiffness.column[b]} + k % 3];
        if (i == kNone || j == kNone || i < j) continue;
        entries.emplace_back(i, j, i == j ? (1 - shift) * stiffness.blocks[b][k] : stiffness.blocks[b][k]);
      }
    }
  }
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

std::ptrdiff_t count_of(const std::vector<bool>& is_free) {
  return std::count(is_free.begin(), is_free.end(), true);
}

}  // namespace

Solution solve_directly(const Stiffness& stiffness, const LoadCase& load_case, const Context& context) {
  FlatProblem problem = flatten(stiffness, load_case);
  const auto number = numbered(problem.is_free);
  const std::ptrdiff_t unknowns = count_of(problem.is_free);
  std::vector<double> internal(problem.displacement.size());
  multiply(stiffness, problem.displacement, internal, context);
  Eigen::VectorXd force(unknowns);
  for (std::size_t k = 0; k < number.size(); ++k) {
    if (number[k] != kNone) force[number[k]] = problem.force[k] - internal[k];
  }
  if (unknowns > 0) {
    const SparseMatrix matrix = reduced(stiffness, number, unknowns, 0);
    const Factorisation factors(matrix);
    // Pivots are at most the diagonal; the last of a body that can move is what rounding leaves of it.
    constexpr double kRounding = 1e-13;
    const double largest = matrix.diagonal().maxCoeff();
    if (factors.info() != Eigen::Success || !(factors.vectorD().minCoeff() > kRounding * largest)) {
      throw Error(ErrorKind::kInput, "mechanics.singular", "the supports leave the body free to move",
                  "hold at least six components at three nodes that are not on a line");
    }
    const Eigen::VectorXd displacement = factors.solve(force);
    for (std::size_t k = 0; k < number.size(); ++k) {
      if (number[k] != kNone) problem.displacement[k] = displacement[number[k]];
    }
  }
  return solution_of(stiffness, problem, context);
}

std::size_t count_eigenvalues_below(const Stiffness& stiffness, double bound) {
  const FlatProblem problem = flatten(stiffness, {});
  const std::ptrdiff_t unknowns = count_of(problem.is_free);
  if (unknowns == 0) return 0;
  const Factorisation factors(reduced(stiffness, numbered(problem.is_free), unknowns, bound));
  const Eigen::VectorXd pivots = factors.vectorD();
  std::size_t negative = 0;
  for (std::ptrdiff_t k = 0; k < unknowns; ++k) negative += pivots[k] < 0 ? 1 : 0;
  return negative;
}

}  // namespace periost
