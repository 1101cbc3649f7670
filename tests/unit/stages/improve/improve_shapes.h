#pragma once
// Small tetrahedral meshes made at run time, with slivers.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "pipeline/base/random.h"
#include "pipeline/data/tet_mesh.h"
#include "pipeline/geometry/tet_faces.h"
#include "pipeline/geometry/tet_quality.h"

namespace periost::test {

// A number between -1 and 1.
inline double jitter(std::uint64_t seed, std::uint64_t i) {
  return 2 * Random(seed, i).uniform() - 1;
}

inline void add_boundary(TetMesh& mesh) {
  mesh.boundary.clear();
  for (const BoundaryFace& face : boundary_faces(tet_neighbours(mesh.tets, mesh.points.size()))) {
    mesh.boundary.push_back(face_of(mesh.tets[face.tet], face.opposite));
  }
}

inline double volume6(const TetMesh& mesh, const Tetrahedron& t) {
  return six_volumes(mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]], mesh.points[t[3]]);
}

inline double whole_volume6(const TetMesh& mesh) {
  double sum = 0;
  for (const Tetrahedron& t : mesh.tets) sum += volume6(mesh, t);
  return sum;
}

// n^3 sheared bricks of six tetrahedra each, far from the origin; points inside are moved by up to `amount`
// of a brick, as long as no tetrahedron is inverted. Layers of bricks below and above `regions_at` differ in
// region.
inline TetMesh bricks(Index n, double amount, std::uint64_t seed, Index regions_at = kNoIndex) {
  TetMesh mesh;
  const auto at = [n](Index i, Index j, Index k) { return i + (n + 1) * (j + (n + 1) * k); };
  for (Index k = 0; k <= n; ++k) {
    for (Index j = 0; j <= n; ++j) {
      for (Index i = 0; i <= n; ++i) {
        mesh.points.push_back({300 + i + 0.1 * k, -150 + 0.8 * j, 75 + 1.2 * k});
      }
    }
  }
  constexpr Index kOrders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  for (Index k = 0; k < n; ++k) {
    for (Index j = 0; j < n; ++j) {
      for (Index i = 0; i < n; ++i) {
        for (const auto& order : kOrders) {
          Index step[3] = {i, j, k};
          Tetrahedron tet{at(i, j, k), 0, 0, 0};
          for (std::size_t s = 0; s < 3; ++s) {
            ++step[order[s]];
            tet[s + 1] = at(step[0], step[1], step[2]);
          }
          if (volume6(mesh, tet) < 0) std::swap(tet[2], tet[3]);
          mesh.tets.push_back(tet);
          mesh.region.push_back(regions_at != kNoIndex && k >= regions_at ? 2 : 1);
        }
      }
    }
  }
  std::uint64_t counter = 0;
  for (Index k = 1; k < n; ++k) {
    if (k == regions_at) continue;
    for (Index j = 1; j < n; ++j) {
      for (Index i = 1; i < n; ++i) {
        Vec3& p = mesh.points[at(i, j, k)];
        const Vec3 kept = p;
        for (std::size_t a = 0; a < 3; ++a) p[a] += amount * jitter(seed, counter++);
        const bool is_valid = std::all_of(mesh.tets.begin(), mesh.tets.end(),
                                          [&](const Tetrahedron& t) { return volume6(mesh, t) > 1e-3; });
        if (!is_valid) p = kept;
      }
    }
  }
  add_boundary(mesh);
  return mesh;
}

// Five tetrahedra that fill an octahedron; the first is flat but for `height`, and all points are on the
// boundary.
inline TetMesh octahedron_with_sliver(double height) {
  TetMesh mesh;
  mesh.points = {{1, 0, 0}, {-1, 0, 0}, {0, 1, height}, {0, -1, height}, {0, 0, 1}, {0, 0, -1}};
  mesh.tets = {{0, 1, 2, 3}, {2, 3, 0, 4}, {2, 3, 1, 4}, {0, 1, 2, 5}, {0, 1, 3, 5}};
  for (Tetrahedron& tet : mesh.tets) {
    if (volume6(mesh, tet) < 0) std::swap(tet[2], tet[3]);
  }
  mesh.region.assign(5, 1);
  add_boundary(mesh);
  return mesh;
}

struct Dihedrals {
  double least = 180, greatest = 0;
};
inline Dihedrals dihedrals(const TetMesh& mesh) {
  Dihedrals all;
  for (const Tetrahedron& t : mesh.tets) {
    const DihedralRange range =
        tet_dihedral_range({mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]], mesh.points[t[3]]});
    all.least = std::min(all.least, range.min_deg);
    all.greatest = std::max(all.greatest, range.max_deg);
  }
  return all;
}

// The smallest dihedral angle that 1 % of tetrahedra are below, in degrees.
inline double first_percentile(const TetMesh& mesh) {
  std::vector<double> least;
  for (const Tetrahedron& t : mesh.tets) {
    least.push_back(
        tet_dihedral_range({mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]], mesh.points[t[3]]})
            .min_deg);
  }
  std::sort(least.begin(), least.end());
  return least[least.size() / 100];
}

// Boundary triangles, each with its smallest corner first, sorted.
inline std::vector<Triangle> sorted_boundary(const std::vector<Triangle>& triangles) {
  std::vector<Triangle> sorted = triangles;
  for (Triangle& t : sorted) std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  std::sort(sorted.begin(), sorted.end());
  return sorted;
}

}  // namespace periost::test
