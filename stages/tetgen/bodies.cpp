#include "stages/tetgen/bodies.h"

#include <algorithm>
#include <limits>

#include "pipeline/base/error.h"
#include "pipeline/geometry/predicates.h"
#include "pipeline/geometry/topology.h"

namespace periost {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Shell {
  std::vector<Triangle> triangles;
  Vec3 low{kInfinity, kInfinity, kInfinity}, high{-kInfinity, -kInfinity, -kInfinity};
  double volume6 = 0;  // six times the enclosed volume, negative when normals point inward

  bool box_contains(Vec3 p) const {
    return low.x <= p.x && p.x <= high.x && low.y <= p.y && p.y <= high.y && low.z <= p.z && p.z <= high.z;
  }
};

std::vector<Shell> gather(const SurfaceMesh& surface, const std::vector<std::uint32_t>& shell_of) {
  std::vector<Shell> shells(1 + *std::max_element(shell_of.begin(), shell_of.end()));
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    Shell& shell = shells[shell_of[t]];
    shell.triangles.push_back(surface.triangles[t]);
    const Vec3 origin = surface.points[shell.triangles[0][0]];
    Vec3 corner[3];
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 p = surface.points[surface.triangles[t][k]];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        shell.low[axis] = std::min(shell.low[axis], p[axis]);
        shell.high[axis] = std::max(shell.high[axis], p[axis]);
      }
      corner[k] = p - origin;
    }
    shell.volume6 += dot(corner[0], cross(corner[1], corner[2]));
  }
  return shells;
}

bool is_inside(const SurfaceMesh& surface, const Shell& shell, Vec3 point) {
  return shell.box_contains(point) && is_inside_by_parity(surface.points, shell.triangles, point);
}

// Distance along the unit vector `direction` to the triangle, or infinity.
double hit_distance(const TriangleCorners& t, Vec3 from, Vec3 direction) {
  const Vec3 u = t[1] - t[0], v = t[2] - t[0];
  const Vec3 p = cross(direction, v);
  const double determinant = dot(u, p);
  if (determinant == 0) return kInfinity;
  const Vec3 w = from - t[0];
  const double a = dot(w, p) / determinant;
  const Vec3 q = cross(w, u);
  const double b = dot(direction, q) / determinant;
  // A generous border: a hit too many only brings the seed nearer to its own wall.
  constexpr double kBorder = 1e-6;
  if (a < -kBorder || b < -kBorder || a + b > 1 + kBorder) return kInfinity;
  return dot(v, q) / determinant;
}

// Half-way from the centre of a triangle of the wall to whatever comes first on the other side.
Vec3 seed_behind(const SurfaceMesh& surface, const Shell& wall, const Triangle& triangle) {
  const Vec3 a = surface.points[triangle[0]], b = surface.points[triangle[1]],
             c = surface.points[triangle[2]];
  const Vec3 outward = normalized(cross(b - a, c - a)) * (wall.volume6 > 0 ? 1.0 : -1.0);
  const Vec3 centre = (a + b + c) / 3;
  double nearest = distance(wall.low, wall.high);
  for (const Triangle& other : surface.triangles) {
    if (other == triangle) continue;
    const double hit = hit_distance(
        {surface.points[other[0]], surface.points[other[1]], surface.points[other[2]]}, centre, -outward);
    if (hit > 0) nearest = std::min(nearest, hit);
  }
  return centre - outward * (0.5 * nearest);
}

// A point inside shell `i` that is `depth` + 1 shells deep: next to the wall, and in none of what it holds.
Vec3 seed_inside(const SurfaceMesh& surface, const std::vector<Shell>& shells, std::size_t i, int depth) {
  std::vector<Triangle> largest = shells[i].triangles;
  const auto squared_area = [&surface](const Triangle& t) {
    return squared_norm(
        cross(surface.points[t[1]] - surface.points[t[0]], surface.points[t[2]] - surface.points[t[0]]));
  };
  const std::size_t tries = std::min<std::size_t>(largest.size(), 20);
  std::partial_sort(largest.begin(), largest.begin() + static_cast<std::ptrdiff_t>(tries), largest.end(),
                    [&](const Triangle& s, const Triangle& t) { return squared_area(s) > squared_area(t); });
  for (std::size_t k = 0; k < tries; ++k) {
    const Vec3 seed = seed_behind(surface, shells[i], largest[k]);
    if (!is_inside(surface, shells[i], seed)) continue;
    const auto around = std::count_if(shells.begin(), shells.end(),
                                      [&](const Shell& shell) { return is_inside(surface, shell, seed); });
    if (around == depth + 1) return seed;
  }
  throw Error(ErrorKind::kInternal, "tetgen.no_seed", "no point could be found inside a cavity",
              "fill the cavities of the mask with fill_holes");
}

}  // namespace

std::size_t Bodies::body_count() const {
  return static_cast<std::size_t>(
      std::count_if(depth.begin(), depth.end(), [](int d) { return d % 2 == 0; }));
}

Bodies find_bodies(const SurfaceMesh& surface, Cavities cavities, const Context& context) {
  Bodies bodies;
  bodies.shell_of_triangle = triangle_components(surface.triangles, surface.points.size());
  const std::vector<Shell> shells = gather(surface, bodies.shell_of_triangle);
  std::vector<std::vector<std::size_t>> around(shells.size());
  for (std::size_t i = 0; i < shells.size(); ++i) {
    context.check_cancelled();
    const Vec3 point = surface.points[shells[i].triangles[0][0]];
    for (std::size_t j = 0; j < shells.size(); ++j) {
      if (i != j && is_inside(surface, shells[j], point)) around[i].push_back(j);
    }
    bodies.depth.push_back(static_cast<int>(around[i].size()));
  }
  bodies.number.assign(shells.size(), 0);
  std::int32_t count = 0;
  for (std::size_t i = 0; i < shells.size(); ++i) {
    if (bodies.depth[i] % 2 == 0) bodies.number[i] = ++count;
    bodies.turned_shells += (shells[i].volume6 > 0) == (bodies.depth[i] % 2 == 0) ? 0 : 1;
  }
  for (std::size_t i = 0; i < shells.size(); ++i) {
    const bool is_cavity = bodies.depth[i] % 2 == 1;
    if (!is_cavity && cavities == Cavities::kEmpty) continue;
    context.check_cancelled();
    const Vec3 seed = seed_inside(surface, shells, i, bodies.depth[i]);
    if (cavities == Cavities::kFilled) {
      bodies.region_seeds.push_back(seed);
      if (is_cavity) bodies.number[i] = ++count;
      continue;
    }
    bodies.cavity_seeds.push_back(seed);
    // The body around a cavity is the deepest shell around it.
    const auto owner =
        *std::max_element(around[i].begin(), around[i].end(),
                          [&](std::size_t a, std::size_t b) { return bodies.depth[a] < bodies.depth[b]; });
    bodies.number[i] = bodies.number[owner];
  }
  return bodies;
}

}  // namespace periost
