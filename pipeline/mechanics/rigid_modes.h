#pragma once
// Motions of a free body that cost no energy. A sound body has six: three translations and three rotations.
// More say that it is in pieces, or hinged at an edge or a node: a solver then stops at a singular matrix, or
// goes on and gives displacements of kilometres.
#include <cstddef>

#include "pipeline/base/context.h"
#include "pipeline/data/tet_mesh.h"
#include "pipeline/mechanics/stiffness.h"

namespace periost {

struct RigidModes {
  std::size_t count = 0;   // motions without energy
  std::size_t bodies = 0;  // that share no node
  double error = 0;        // largest |K r| at a node, to its row sum of |K| times the largest |r|; r: the six
};

// `count` is the larger of two numbers. By connectivity: tetrahedra joined across faces move as one rigid
// body, and where bodies share nodes only, what these leave free is counted exactly (up to 200 bodies;
// beyond, six for each). And, for up to 6,000 unknowns, by the eigenvalues of K x = lambda diag(K) x below
// 1e-11, which sees a seventh motion whatever its cause. A rigid motion with an `error` above 1e-10 is no
// motion of K at all and is taken off. Precondition: `stiffness` is that of `mesh`.
RigidModes rigid_modes(const TetMesh& mesh, const Stiffness& stiffness, const Context& context);

// Only what connectivity tells: `count` is the first of the two numbers, `error` 0.
RigidModes rigid_modes_by_connectivity(const TetMesh& mesh);

}  // namespace periost
