#pragma once
// One load case for any two meshes of the same body, however their nodes lie: the body is stretched along the
// longest side of its bounding box. It answers what a decimated surface costs a stress analysis
// (docs/quality.md, section Mechanics).
//
// Between planes across the axis the two ends, 10 % of the length each, lie in an elastic bed: at depth s of
// the way from the plane to the body's end every mm^3 is held by a spring of 16 s E / t^2, t the thickness of
// the end. The bed below is fixed, the bed above is moved along the axis by 0.1 % of the length. Held nodes
// would be different ones in the two meshes, and where an element straddles the plane the body would be
// longer by half an element in one than in the other; the bed is an integral over space, so that with finer
// meshes both go to the same limit.
#include <cstddef>
#include <optional>

#include "pipeline/base/context.h"
#include "pipeline/data/tet_mesh.h"
#include "pipeline/mechanics/element.h"

namespace periost {

// Where the body is held, shared by all meshes that are to be compared. LPS mm.
struct StretchFrame {
  std::size_t axis = 2;      // 0, 1, 2: x, y, z
  double low = 0, high = 0;  // ends of the body along it

  double length() const { return high - low; }
  double end() const { return 0.1 * length(); }             // thickness of each end
  double displacement() const { return 0.001 * length(); }  // of the bed above
};

// The longest side of the box of the points that tetrahedra use. Precondition: the mesh has tetrahedra.
StretchFrame stretch_frame(const TetMesh& mesh);

struct Stretch {
  double stiffness = 0;             // N/mm: force between the two beds over the displacement
  double energy = 0;                // N mm: strain energy of the body, without the beds'
  double p95_von_mises = 0;         // MPa: 95 % of the volume between 20 % and 80 % of the length has less
  double imbalance = 0;             // of the two beds' forces, as a share: what the solver left over
  std::size_t tets = 0, nodes = 0;  // of the stretched bodies, mid-side nodes included
  std::size_t bodies = 0;           // that reach from half of one end to half of the other
  std::size_t left_out = 0;         // bodies that do not
  std::size_t iterations = 0;       // of conjugate gradients
  bool has_converged = false;
};

// Bytes that stretch takes for a mesh at an order, 1 or 2, most of them the matrix's.
std::size_t stretch_bytes(const TetMesh& mesh, int order);

// Stretches the bodies (joined across faces) that span the frame; empty where none does. Whatever the order
// of the mesh, elements have the order asked for: 2 raises a mesh of first order with straight edges, 1
// leaves mid-side nodes out. Linear tetrahedra are too stiff in bending, the more so the larger they are, so
// at order 1 only meshes of about equal element size compare. von Mises stress is taken at the integration
// points, each with its share of the volume. Conjugate gradients to 1e-6 of the residual. The same bits for
// any number of threads. Preconditions: `order` is 1 or 2; no element folds (folded_tets).
std::optional<Stretch> stretch(const TetMesh& mesh, const StretchFrame& frame, const Material& material,
                               int order, const Context& context);

}  // namespace periost
