#pragma once
// Small closed surfaces made at run time, normals outward.
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <utility>

#include "pipeline/data/surface_mesh.h"

namespace periost::test {

inline SurfaceMesh tetrahedron_surface() {
  SurfaceMesh mesh;
  mesh.points = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}};
  return mesh;
}

// An axis-parallel box from `low` to `high` of twelve triangles.
inline SurfaceMesh box_surface(Vec3 low, Vec3 high) {
  SurfaceMesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.points.push_back({(i & 1) ? high.x : low.x, (i & 2) ? high.y : low.y, (i & 4) ? high.z : low.z});
  }
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

// An icosahedron subdivided `levels` times onto the sphere: 20 * 4^levels triangles.
inline SurfaceMesh sphere_surface(Vec3 centre, double radius, int levels) {
  const double g = std::numbers::phi;
  SurfaceMesh mesh;
  for (const double s : {-1.0, 1.0}) {
    for (const double t : {-g, g}) {
      mesh.points.push_back({0, s, t});
      mesh.points.push_back({s, t, 0});
      mesh.points.push_back({t, 0, s});
    }
  }
  // The triples at edge length 2, outward.
  for (Index a = 0; a < 12; ++a) {
    for (Index b = a + 1; b < 12; ++b) {
      for (Index c = b + 1; c < 12; ++c) {
        const Vec3 p = mesh.points[a], q = mesh.points[b], r = mesh.points[c];
        if (std::abs(distance(p, q) - 2) > 0.1 || std::abs(distance(q, r) - 2) > 0.1 ||
            std::abs(distance(r, p) - 2) > 0.1) {
          continue;
        }
        const bool is_outward = dot(p, cross(q, r)) > 0;
        mesh.triangles.push_back(is_outward ? Triangle{a, b, c} : Triangle{a, c, b});
      }
    }
  }
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<Index, Index>, Index> middle;
    const auto middle_of = [&](Index a, Index b) {
      const auto [found, is_new] =
          middle.try_emplace(std::minmax(a, b), static_cast<Index>(mesh.points.size()));
      if (is_new) mesh.points.push_back(0.5 * (mesh.points[a] + mesh.points[b]));
      return found->second;
    };
    std::vector<Triangle> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const Index d = middle_of(a, b), e = middle_of(b, c), f = middle_of(c, a);
      finer.insert(finer.end(), {{a, d, f}, {d, b, e}, {f, e, c}, {d, e, f}});
    }
    mesh.triangles = std::move(finer);
  }
  for (Vec3& p : mesh.points) p = centre + radius * normalized(p);
  return mesh;
}

// A torus about z of n * m * 2 triangles.
inline SurfaceMesh torus_surface(double major, double minor, Index n, Index m) {
  SurfaceMesh mesh;
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < m; ++j) {
      const double u = 2 * std::numbers::pi * i / n, v = 2 * std::numbers::pi * j / m;
      const double r = major + minor * std::cos(v);
      mesh.points.push_back({r * std::cos(u), r * std::sin(u), minor * std::sin(v)});
    }
  }
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < m; ++j) {
      const Index a = i * m + j, b = (i + 1) % n * m + j, c = (i + 1) % n * m + (j + 1) % m,
                  d = i * m + (j + 1) % m;
      mesh.triangles.push_back({a, b, c});
      mesh.triangles.push_back({a, c, d});
    }
  }
  return mesh;
}

// Both surfaces in one mesh, unconnected.
inline SurfaceMesh joined(SurfaceMesh mesh, const SurfaceMesh& other) {
  const auto shift = static_cast<Index>(mesh.points.size());
  mesh.points.insert(mesh.points.end(), other.points.begin(), other.points.end());
  for (const auto& [a, b, c] : other.triangles) mesh.triangles.push_back({a + shift, b + shift, c + shift});
  return mesh;
}

// Every triangle turned over: the wall of a cavity.
inline SurfaceMesh inverted(SurfaceMesh mesh) {
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
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
