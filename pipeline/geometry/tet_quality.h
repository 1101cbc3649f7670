#pragma once
// Shape of one tetrahedron. Corners in VTK's order (positive volume: d on the side that the normal of a, b, c
// points to). Metrics that Verdict has keep its definition (Stimpson et al. 2007, section 6); dihedral angles
// are the true ones between faces. Unless stated, metrics are invariant under rigid motion, scale and even
// renumbering, and a degenerate tetrahedron gets the worst value of the range.
#include <array>

#include "pipeline/data/tet_mesh.h"
#include "pipeline/data/vec.h"

namespace periost {

using TetCorners = std::array<Vec3, 4>;
// Corners, then mid-side nodes on edges 01, 12, 20, 03, 13, 23.
using Tet10Nodes = std::array<Vec3, 10>;

// Of tetrahedron t of a mesh; the nodes of one of second order.
TetCorners tet_corners(const TetMesh& mesh, std::size_t t);
Tet10Nodes tet10_nodes(const TetMesh& mesh, std::size_t t);

// (b - a) . ((c - a) x (d - a)) / 6, in mm^3; negative when inverted.
double tet_volume(const TetCorners& t);

// Smallest and largest of the six angles between faces, in degrees, each pi minus the angle between the
// outward normals. Ranges 0..70.53 and 70.53..180; both acos(1/3) = 70.5288 for the regular tetrahedron.
// The sign of the volume does not matter. A face without area gives 0 and 180.
struct DihedralRange {
  double min_deg = 0, max_deg = 180;
};
DihedralRange tet_dihedral_range(const TetCorners& t);

// R / (3 r), circumradius over three times the inradius. Range 1..1e30; 1 for the regular tetrahedron; 1e30
// when the volume is not positive.
double tet_radius_ratio(const TetCorners& t);

// sqrt(2) J / max over the corners of the product of its three edges, and J = 6 V. Range -1..1; 1 for the
// regular tetrahedron, <= 0 when inverted.
double tet_scaled_jacobian(const TetCorners& t);

// Knupp's shape, which for tetrahedra is the mean ratio: 12 (3 V)^(2/3) / (sum of the squared edges).
// Range 0..1; 1 for the regular tetrahedron; 0 when the volume is not positive.
double tet_mean_ratio(const TetCorners& t);

// Longest edge / (2 sqrt(6) r), r the inradius. Range 1..1e30; 1 for the regular tetrahedron; 1e30 when the
// volume is not positive.
double tet_aspect_ratio(const TetCorners& t);

// Larger to smaller cube root of two volumes' magnitudes: max / min. Range 1..1e30; 1e30 when one is zero.
double tet_size_ratio(double volume_a, double volume_b);

// Of a second-order tetrahedron: smallest determinant J of its mapping over the largest |J|, both over the
// four corners, the six mid-side nodes and the four Gauss points of degree 2. Range -1..1; 1 with straight
// edges and centred nodes; <= 0 means that the mapping folds at one of these points.
double tet10_jacobian_ratio(const Tet10Nodes& t);

// The smallest of the determinants at the four corners alone, in mm^3 (6 V for straight edges).
double tet10_min_corner_jacobian(const Tet10Nodes& t);

}  // namespace periost
