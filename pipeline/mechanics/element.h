#pragma once
// One tetrahedron of an isotropic, linear-elastic body at small strains: the gradients of its shape functions
// at integration points, from which its stiffness, its strain and its stress follow. First order (4 nodes)
// and second order (10 nodes in the order of pipeline/data/tet_mesh.h). Lengths in mm, moduli and stresses in
// MPa, forces in N. Nothing is allocated; nothing throws.
#include <array>
#include <cstddef>
#include <span>

#include "pipeline/data/tet_mesh.h"
#include "pipeline/data/vec.h"

namespace periost {

// Cortical bone by default. Where only ratios matter (every check of fitness.h) the modulus has no effect.
struct Material {
  double young_mpa = 17000;
  double poisson = 0.3;  // between -1 and 0.5, both excluded
};

// The two constants of Hooke's law: stress = lambda tr(strain) 1 + 2 mu strain.
struct LameConstants {
  double lambda = 0, mu = 0;
};
LameConstants lame_constants(const Material& material);

// Nodes of an element of a mesh: 4 or 10, and the k-th of them.
inline std::size_t nodes_per_tet(const TetMesh& mesh) {
  return mesh.order() == 2 ? 10 : 4;
}
inline Index tet_node(const TetMesh& mesh, std::size_t tet, std::size_t k) {
  return k < 4 ? mesh.tets[tet][k] : mesh.midside[tet][k - 4];
}

struct IntegrationPoint {
  double volume = 0;  // weight times determinant, mm^3; all of them add up to the element's volume
  std::array<Vec3, 10> gradient;  // of each node's shape function, 1/mm; the first 4 at first order
};

struct ElementShape {
  std::size_t nodes = 0;   // 4 or 10
  std::size_t points = 0;  // 1, 4 or 14
  std::array<IntegrationPoint, 14> at;
};

// The element's shape at its integration points: one at first order; at second order the four of degree 2,
// which integrate the stiffness of straight edges exactly, and the 14 of degree 5 (Walkington 2000) where a
// mid-side node is off the middle by more than 1e-10 of its edge: fewer would fail the patch test there.
// A volume that is not positive says that the element folds at that point; gradients are then meaningless.
// Precondition: 4 or 10 nodes.
ElementShape element_shape(std::span<const Vec3> nodes);
ElementShape element_shape(const TetMesh& mesh, std::size_t tet);

// Whether every integration point has positive volume.
bool is_regular(const ElementShape& shape);

// The 3 x 3 block of the stiffness that couples nodes i and j, row by row, in N/mm: force on i for a
// displacement of j. Block (j, i) is its transpose to the last bit.
using Block = std::array<double, 9>;
Block stiffness_block(const ElementShape& shape, const LameConstants& lame, std::size_t i, std::size_t j);

// Components xx, yy, zz, xy, yz, zx.
using Stress = std::array<double, 6>;
// The stress at an integration point for the displacements of the element's nodes.
Stress stress_at(const IntegrationPoint& point, const LameConstants& lame,
                 std::span<const Vec3> displacement);
double von_mises(const Stress& stress);

}  // namespace periost
