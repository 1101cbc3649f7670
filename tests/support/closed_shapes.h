#pragma once
// Closed surfaces for tests, made at run time.
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "pipeline/data/surface_mesh.h"

namespace periost::test {

// An icosahedron refined `levels` times and put on the sphere: 20 * 4^levels triangles, normals outward.
inline SurfaceMesh sphere(Vec3 centre, double radius, int levels) {
  const double g = std::numbers::phi;
  SurfaceMesh mesh;
  mesh.points = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                 {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  mesh.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                    {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                    {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<Index, Index>, Index> middle;
    const auto middle_of = [&](Index a, Index b) {
      const auto [found, is_new] =
          middle.try_emplace(std::minmax(a, b), static_cast<Index>(mesh.points.size()));
      if (is_new) mesh.points.push_back(normalized(mesh.points[a]) + normalized(mesh.points[b]));
      return found->second;
    };
    std::vector<Triangle> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const Index ab = middle_of(a, b), bc = middle_of(b, c), ca = middle_of(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    mesh.triangles = std::move(finer);
  }
  for (Vec3& point : mesh.points) point = centre + normalized(point) * radius;
  return mesh;
}

// The box between two corners, two triangles a side, normals outward.
inline SurfaceMesh box(Vec3 low, Vec3 high) {
  SurfaceMesh mesh;
  for (int corner = 0; corner < 8; ++corner) {
    mesh.points.push_back({(corner & 1) != 0 ? high.x : low.x, (corner & 2) != 0 ? high.y : low.y,
                           (corner & 4) != 0 ? high.z : low.z});
  }
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

// Every triangle turned over: the wall of a cavity.
inline SurfaceMesh inverted(SurfaceMesh mesh) {
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

// Both, as one mesh, the second's points behind the first's.
inline SurfaceMesh joined(SurfaceMesh a, const SurfaceMesh& b) {
  const auto offset = static_cast<Index>(a.points.size());
  a.points.insert(a.points.end(), b.points.begin(), b.points.end());
  for (const auto& [p, q, r] : b.triangles) a.triangles.push_back({p + offset, q + offset, r + offset});
  return a;
}

inline double enclosed_volume(const SurfaceMesh& mesh) {
  double sum = 0;
  const Vec3 origin = mesh.points[0];
  for (const auto& [a, b, c] : mesh.triangles) {
    sum += dot(mesh.points[a] - origin, cross(mesh.points[b] - origin, mesh.points[c] - origin));
  }
  return sum / 6;
}

}  // namespace periost::test
