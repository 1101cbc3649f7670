#pragma once
// Small tetrahedral meshes made at run time.
#include <algorithm>
#include <array>
#include <cstddef>

#include "pipeline/base/random.h"
#include "pipeline/data/tet_mesh.h"
#include "pipeline/geometry/tet_faces.h"

namespace periost::test {

struct BoxMeshOptions {
  Vec3 low{-31, 52, 107};
  Vec3 cell{1, 1, 1};  // mm
  std::array<Index, 3> cells{4, 4, 4};
  double shake = 0;  // of points inside, as a share of the cell; 0.3 makes slivers
  int order = 1;
};

// A box of six tetrahedra a cell, all of positive volume for a shake up to 0.3.
inline TetMesh box_mesh(const BoxMeshOptions& options) {
  TetMesh mesh;
  const auto [nx, ny, nz] = options.cells;
  Random random(7, 0);
  for (Index z = 0; z <= nz; ++z) {
    for (Index y = 0; y <= ny; ++y) {
      for (Index x = 0; x <= nx; ++x) {
        Vec3 at{static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)};
        const bool is_inside = x > 0 && x < nx && y > 0 && y < ny && z > 0 && z < nz;
        for (std::size_t axis = 0; axis < 3 && is_inside; ++axis) {
          at[axis] += options.shake * (2 * random.uniform() - 1);
        }
        mesh.points.push_back(options.low +
                              Vec3{at.x * options.cell.x, at.y * options.cell.y, at.z * options.cell.z});
      }
    }
  }
  const std::array<Index, 3> step{1, nx + 1, (nx + 1) * (ny + 1)};
  constexpr std::array<std::array<std::size_t, 3>, 6> kPaths{
      {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {1, 0, 2}, {2, 1, 0}}};
  for (Index z = 0; z < nz; ++z) {
    for (Index y = 0; y < ny; ++y) {
      for (Index x = 0; x < nx; ++x) {
        const Index a = x + y * step[1] + z * step[2];
        for (std::size_t path = 0; path < 6; ++path) {  // along three edges to the opposite corner
          const Index b = a + step[kPaths[path][0]], c = b + step[kPaths[path][1]];
          const Index d = c + step[kPaths[path][2]];
          mesh.tets.push_back(path < 3 ? Tetrahedron{a, b, c, d} : Tetrahedron{a, c, b, d});
        }
      }
    }
  }
  mesh.region.assign(mesh.tets.size(), 1);
  if (options.order == 2) add_midside_nodes(mesh);
  for (const BoundaryFace& face : boundary_faces(tet_neighbours(mesh.tets, mesh.points.size()))) {
    mesh.boundary.push_back(face_of(mesh.tets[face.tet], face.opposite));
  }
  return mesh;
}

// Moves the mid-side nodes off the middles by up to `amount` mm: curved edges.
inline void bend(TetMesh& mesh, double amount) {
  Random random(11, 0);
  std::size_t first = 0;
  for (const Tetrahedron& tet : mesh.tets) {
    for (const Index corner : tet) first = std::max<std::size_t>(first, corner + 1);
  }
  for (std::size_t p = first; p < mesh.points.size(); ++p) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      mesh.points[p][axis] += amount * (2 * random.uniform() - 1);
    }
  }
}

// A box of 6 x 5 x 7 uneven cells, its points inside shaken, its edges bent by up to `bend_mm`.
inline TetMesh badly_shaped_box(int order, double bend_mm = 0, double shake = 0.3) {
  TetMesh mesh = box_mesh({.cell = {1, 0.7, 1.4}, .cells = {6, 5, 7}, .shake = shake, .order = order});
  if (bend_mm > 0) bend(mesh, bend_mm);
  return mesh;
}

}  // namespace periost::test
