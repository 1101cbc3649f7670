#pragma once
// Static equilibrium of a linear-elastic mesh under prescribed displacements and nodal forces: K u = f.
// A direct and an iterative solver, which agree to the tolerance of the latter. mm, N, MPa.
#include <cstddef>
#include <span>
#include <vector>

#include "pipeline/base/context.h"
#include "pipeline/mechanics/stiffness.h"

namespace periost {

// One component of one node's displacement is prescribed, in mm.
struct Support {
  Index node = 0;
  int axis = 0;  // 0, 1, 2: x, y, z
  double displacement = 0;
};

struct NodalLoad {
  Index node = 0;
  Vec3 force;  // N
};

// Of two supports of one component the last counts; loads add up. A load on a supported component goes into
// the ground.
struct LoadCase {
  std::vector<Support> supports;
  std::vector<NodalLoad> loads;
};

struct Solution {
  std::vector<Vec3> displacement;  // one per point of the mesh; 0 where no tetrahedron is
  std::vector<Vec3> reaction;      // force of the ground on the body; 0 but at supported components
  double energy = 0;               // strain energy u . K u / 2, in N mm
  std::size_t iterations = 0;      // of the iterative solver
  bool has_converged = true;       // the tolerance was met
};

// Sparse LDL^T. For bodies of up to some ten thousand nodes: time and memory grow with the fill-in. One
// thread. Throws Error{kInput, "mechanics.singular"} where the supports leave the body free to move.
Solution solve_directly(const Stiffness& stiffness, const LoadCase& load_case, const Context& context);

struct IterativeOptions {
  double tolerance = 1e-10;            // of the residual's norm in the preconditioner, to that at the start
  std::size_t max_iterations = 20000;  // has_converged is false when they do not suffice
  std::span<const Vec3> points{};      // the nodes' places: adds the motions of lumps (coarse_space.h)
};

// Conjugate gradients from zero, preconditioned by the diagonal (Jacobi) and, where the nodes' places are
// given, by the rigid motions of lumps of nodes, with which long bodies take some ten times fewer iterations.
// The same bits for any number of threads.
Solution solve_iteratively(const Stiffness& stiffness, const LoadCase& load_case,
                           const IterativeOptions& options, const Context& context);

// How many eigenvalues of K x = lambda diag(K) x lie below `bound`, by the signs of the pivots of
// K - bound diag(K) (Sylvester). With a small bound these are the motions that cost no energy. One
// factorisation.
std::size_t count_eigenvalues_below(const Stiffness& stiffness, double bound);

}  // namespace periost
