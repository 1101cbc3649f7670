#pragma once
// The stiffness matrix of a mesh: sparse, by 3 x 3 blocks of nodes, symmetric to the last bit. Rows are
// filled apart from one another, each in the order of its tetrahedra, so it has the same bits for any number
// of threads.
#include <cstddef>
#include <span>
#include <vector>

#include "pipeline/base/context.h"
#include "pipeline/data/tet_mesh.h"
#include "pipeline/mechanics/element.h"

namespace periost {

// Row n holds the blocks first[n] .. first[n + 1] - 1. A point that no tetrahedron uses has an empty row.
struct Stiffness {
  std::vector<std::size_t> first;  // one more than there are points
  std::vector<Index> column;       // ascending in a row
  std::vector<Block> blocks;       // N/mm

  std::size_t nodes() const { return first.size() - 1; }
  bool is_used(std::size_t node) const { return first[node] != first[node + 1]; }
  // The position of block (row, col), which must be there. O(log of the row's length).
  std::size_t find(std::size_t row, Index col) const;
};

// Assembles the free body: no supports. Memory: 76 bytes a block; 11 to 15 blocks a point at first order,
// some 300 bytes a tetrahedron, and 23 to 28 at second, some 3.5 kB a tetrahedron. Time on one thread: some 3
// microseconds a tetrahedron at first order, 30 at second.
// Precondition: indices valid, every element regular (is_regular); an element that folds gives nonsense.
Stiffness assemble_stiffness(const TetMesh& mesh, const Material& material, const Context& context);

// The tetrahedra that fold at an integration point, ascending.
std::vector<std::size_t> folded_tets(const TetMesh& mesh, const Context& context);

// product = K x, three numbers a node. Precondition: both hold 3 * nodes() numbers.
void multiply(const Stiffness& stiffness, std::span<const double> x, std::span<double> product,
              const Context& context);

}  // namespace periost
