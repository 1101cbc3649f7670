#pragma once
// A tetrahedral mesh in LPS millimetres, of first or second order.
#include <array>
#include <cstdint>
#include <vector>

#include "pipeline/data/surface_mesh.h"

namespace periost {

// Corners in VTK's order: positive volume means that (p1 - p0) . ((p2 - p0) x (p3 - p0)) > 0 (p3 on the side
// that the normal of 0, 1, 2 points to).
using Tetrahedron = std::array<Index, 4>;
// Mid-side nodes of a second-order tetrahedron in VTK's order: on edges 01, 12, 20, 03, 13, 23.
using MidsideNodes = std::array<Index, 6>;

struct TetMesh {
  std::vector<Vec3> points;  // corners and mid-side nodes
  std::vector<Tetrahedron> tets;
  std::vector<MidsideNodes> midside;  // empty when order is 1, else one per tet
  std::vector<std::int32_t> region;   // one per tet: number of the separate body, from 1
  std::vector<Triangle> boundary;     // outward triangles of the boundary, corners only
  Fields point_fields;
  Fields tet_fields;
  double voxel_mm = 0;             // largest voxel side of the image behind it; 0: none
  bool boundary_preserved = true;  // the mesher kept every triangle of the surface it was given

  int order() const { return midside.empty() ? 1 : 2; }
};

}  // namespace periost
