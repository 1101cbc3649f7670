#pragma once
// How hard a mesh makes it for a solver, relative to ideal elements of the same mean size. Badly shaped and
// very large elements raise the largest eigenvalue of the stiffness, small ones lower the smallest; the time
// of an iterative solver goes with the root of their quotient (Shewchuk, What is a good linear finite
// element, 2002).
//
// The reference is a block of the body-centred cubic lattice: all its tetrahedra are congruent, with dihedral
// angles of 60 and 90 degrees and edges in the proportion 2 : sqrt(3), the best shape that fills space by
// copies of itself. Their volume is the mean volume of the mesh's tetrahedra; order and material are the
// mesh's.
#include <cstddef>
#include <vector>

#include "pipeline/base/context.h"
#include "pipeline/data/tet_mesh.h"
#include "pipeline/mechanics/stiffness.h"

namespace periost {

// A block of cells x cells x cells cubes of the lattice with 12 cells^2 (cells - 1) tetrahedra of the given
// volume; its outside is ragged, so that every one is ideal. A few points stay unused.
TetMesh ideal_mesh(Index cells, double tet_volume, int order);

// The largest eigenvalue of each element's stiffness matrix, in N/mm. Parallel; some microseconds a
// tetrahedron at first order and some tens at second.
std::vector<double> largest_eigenvalues(const TetMesh& mesh, const Material& material,
                                        const Context& context);

// Iterations of conjugate gradients with Jacobi's preconditioner until the residual is 1e-6 of its start, for
// a body on an elastic bed under a random force at every node (the same in every run). The bed is of springs:
// each tetrahedron of volume V gives its nodes together E V / (2 h)^2, with h^3 = 6 V. It parts what is
// farther away than a few elements, so that the number speaks of the shape of the elements, and neither of
// the body's size, slenderness or supports nor of its grading: blocks of ideal elements from 2,000 on agree
// within 3 %. Adds the springs to `stiffness`. Precondition: `stiffness` is that of `mesh`.
std::size_t iterations_on_bed(const TetMesh& mesh, const Material& material, Stiffness& stiffness,
                              const Context& context);

struct Conditioning {
  std::vector<double> eigenvalue_ratio;  // per tetrahedron: its largest eigenvalue to the ideal one's
  std::size_t iterations = 0;            // on the bed
  std::size_t ideal_iterations = 0;      // of the reference, 6 x 6 x 6 cubes
};

// Uses `stiffness` up: springs are added to it. Precondition: it is that of `mesh`, elements regular.
Conditioning conditioning(const TetMesh& mesh, const Material& material, Stiffness& stiffness,
                          const Context& context);

}  // namespace periost
