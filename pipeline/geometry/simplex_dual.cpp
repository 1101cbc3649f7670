#include "pipeline/geometry/simplex_dual.h"

#include <fmt/format.h>

#include <algorithm>

#include "pipeline/base/error.h"
#include "pipeline/geometry/simplex_walk.h"

namespace periost {
namespace {

constexpr std::array<std::size_t, 3> kNext{1, 2, 0};
constexpr std::array<std::size_t, 3> kPrevious{2, 0, 1};

[[noreturn]] void refuse(const char* what, Vec3 place) {
  throw Error(ErrorKind::kQuality, "surface.not_manifold",
              fmt::format("the surface is not a manifold: {} near ({:.3f}, {:.3f}, {:.3f}) mm", what, place.x,
                          place.y, place.z),
              "repair the surface, or extract it with marching_cubes, which makes manifolds only");
}

void check_indices(const SurfaceMesh& surface) {
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const Triangle& corners = surface.triangles[t];
    for (const Index corner : corners) {
      if (corner >= surface.points.size()) {
        throw Error(ErrorKind::kQuality, "surface.bad_index",
                    fmt::format("triangle {} names point {}, but the surface has {} points", t, corner,
                                surface.points.size()));
      }
    }
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) {
      refuse("a triangle has a corner twice", surface.points[corners[0]]);
    }
  }
}

// New numbers of the used points, in order.
std::vector<Index> number_used_points(const SurfaceMesh& surface, Index& used) {
  std::vector<Index> number(surface.points.size(), kNoIndex);
  for (const Triangle& corners : surface.triangles) {
    for (const Index corner : corners) number[corner] = 0;
  }
  used = 0;
  for (Index& n : number) {
    if (n != kNoIndex) n = used++;
  }
  return number;
}

// One side of a triangle; `first` and `second` are its faces in ascending order.
struct Side {
  Index second;
  Index vertex;
  std::uint8_t slot;
  bool ascending;  // the triangle runs from the lower face to the higher
};

// Matches the sides of all triangles: those with the same lower face stand together, a handful each.
void link_neighbours(SimplexMesh& mesh) {
  const std::size_t faces = mesh.dual_position.size();
  std::vector<std::size_t> start(faces + 1, 0);
  const auto ends = [&](std::size_t v, std::size_t k) {
    return std::pair{index_of(mesh.face[v][kNext[k]]), index_of(mesh.face[v][kPrevious[k]])};
  };
  for (std::size_t v = 0; v < mesh.face.size(); ++v) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [a, b] = ends(v, k);
      ++start[std::min(a, b) + 1];
    }
  }
  for (std::size_t f = 0; f < faces; ++f) start[f + 1] += start[f];
  std::vector<Side> sides(start[faces]);
  std::vector<std::size_t> fill(start.begin(), start.end() - 1);
  for (std::size_t v = 0; v < mesh.face.size(); ++v) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [a, b] = ends(v, k);
      sides[fill[std::min(a, b)]++] = {std::max(a, b), static_cast<Index>(v), static_cast<std::uint8_t>(k),
                                       a < b};
    }
  }
  for (std::size_t f = 0; f < faces; ++f) {
    const auto begin = sides.begin() + static_cast<std::ptrdiff_t>(start[f]);
    const auto end = sides.begin() + static_cast<std::ptrdiff_t>(start[f + 1]);
    std::sort(begin, end, [](const Side& a, const Side& b) {
      return std::pair{a.second, a.vertex} < std::pair{b.second, b.vertex};
    });
    for (auto side = begin; side != end;) {
      const auto mate = side + 1;
      if (mate == end || mate->second != side->second) {
        ++side;
        continue;
      }
      const Vec3 place = 0.5 * (mesh.dual_position[f] + mesh.dual_position[side->second]);
      if (mate + 1 != end && (mate + 1)->second == side->second)
        refuse("an edge has more than two triangles", place);
      if (mate->ascending == side->ascending) refuse("two neighbouring triangles face opposite ways", place);
      mesh.neighbour[side->vertex][side->slot] = vertex_at(mate->vertex);
      mesh.neighbour[mate->vertex][mate->slot] = vertex_at(side->vertex);
      side += 2;
    }
  }
}

// On an open fan the walk must begin at its first vertex; a fan that is not all of the face's triangles means
// that several sheets touch in the point.
void check_fans(SimplexMesh& mesh) {
  for (std::size_t f = 0; f < mesh.valence.size(); ++f) {
    const SimplexVertex begin = mesh.first_vertex[f];
    SimplexVertex v = begin;
    do {
      const SimplexVertex before = previous_around(mesh, v, face_at(f));
      if (before == kNoVertex) break;
      v = before;
    } while (v != begin);
    mesh.first_vertex[f] = v;
    std::uint32_t length = 0;
    const SimplexVertex first = v;
    do {
      ++length;
      v = next_around(mesh, v, face_at(f));
    } while (v != kNoVertex && v != first);
    if (length != mesh.valence[f]) refuse("sheets touch in one point", mesh.dual_position[f]);
  }
}

template <class T>
void keep_marked(std::vector<T>& values, const std::vector<Index>& number) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (number[i] != kNoIndex) values[kept++] = values[i];
  }
  values.resize(kept);
}

}  // namespace

SimplexMesh dual_simplex_mesh(const SurfaceMesh& surface) {
  check_indices(surface);
  Index faces = 0;
  const std::vector<Index> number = number_used_points(surface, faces);
  SimplexMesh mesh;
  mesh.voxel_mm = surface.voxel_mm;
  mesh.dual_position = surface.points;
  keep_marked(mesh.dual_position, number);
  mesh.face_fields = surface.point_fields;
  for (auto& [name, values] : mesh.face_fields) keep_marked(values, number);

  const std::size_t vertices = surface.triangles.size();
  mesh.position.resize(vertices);
  mesh.face.resize(vertices);
  mesh.neighbour.assign(vertices, {kNoVertex, kNoVertex, kNoVertex});
  mesh.first_vertex.assign(faces, kNoVertex);
  mesh.valence.assign(faces, 0);
  for (std::size_t v = 0; v < vertices; ++v) {
    const Triangle& corners = surface.triangles[v];
    mesh.position[v] =
        (surface.points[corners[0]] + surface.points[corners[1]] + surface.points[corners[2]]) / 3.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Index f = number[corners[k]];
      mesh.face[v][k] = face_at(f);
      if (mesh.valence[f]++ == 0) mesh.first_vertex[f] = vertex_at(v);
    }
  }
  link_neighbours(mesh);
  check_fans(mesh);
  mesh.report.triangles_before = mesh.report.triangles_after = vertices;
  return mesh;
}

SurfaceMesh dual_triangulation(const SimplexMesh& mesh) {
  SurfaceMesh surface;
  surface.voxel_mm = mesh.voxel_mm;
  std::vector<Index> number(mesh.valence.size(), kNoIndex);
  for (std::size_t f = 0; f < mesh.valence.size(); ++f) {
    if (mesh.valence[f] == 0) continue;
    number[f] = static_cast<Index>(surface.points.size());
    surface.points.push_back(mesh.dual_position[f]);
  }
  surface.point_fields = mesh.face_fields;
  for (auto& [name, values] : surface.point_fields) keep_marked(values, number);
  for (const auto& faces : mesh.face) {
    if (faces[0] == kNoFace) continue;
    surface.triangles.push_back(
        {number[index_of(faces[0])], number[index_of(faces[1])], number[index_of(faces[2])]});
  }
  return surface;
}

void compact(SimplexMesh& mesh) {
  std::vector<Index> vertex_number(mesh.face.size(), kNoIndex), face_number(mesh.valence.size(), kNoIndex);
  Index vertices = 0, faces = 0;
  for (std::size_t v = 0; v < mesh.face.size(); ++v) {
    if (mesh.is_live(vertex_at(v))) vertex_number[v] = vertices++;
  }
  for (std::size_t f = 0; f < mesh.valence.size(); ++f) {
    if (mesh.is_live(face_at(f))) face_number[f] = faces++;
  }
  keep_marked(mesh.position, vertex_number);
  keep_marked(mesh.neighbour, vertex_number);
  keep_marked(mesh.face, vertex_number);
  keep_marked(mesh.first_vertex, face_number);
  keep_marked(mesh.valence, face_number);
  keep_marked(mesh.dual_position, face_number);
  for (auto& [name, values] : mesh.face_fields) keep_marked(values, face_number);
  for (auto& around : mesh.neighbour) {
    for (SimplexVertex& w : around) {
      if (w != kNoVertex) w = vertex_at(vertex_number[index_of(w)]);
    }
  }
  for (auto& around : mesh.face) {
    for (SimplexFace& f : around) f = face_at(face_number[index_of(f)]);
  }
  for (SimplexVertex& v : mesh.first_vertex) v = vertex_at(vertex_number[index_of(v)]);
}

SimplexComponents components_of(const SimplexMesh& mesh) {
  SimplexComponents components;
  components.of_vertex.assign(mesh.face.size(), kNoIndex);
  std::vector<std::uint32_t> stack;
  for (std::uint32_t seed = 0; seed < mesh.face.size(); ++seed) {
    if (components.of_vertex[seed] != kNoIndex || !mesh.is_live(SimplexVertex{seed})) continue;
    components.of_vertex[seed] = components.count;
    stack.push_back(seed);
    while (!stack.empty()) {
      const std::uint32_t v = stack.back();
      stack.pop_back();
      for (const SimplexVertex w : mesh.neighbour[v]) {
        if (w == kNoVertex || components.of_vertex[index_of(w)] != kNoIndex) continue;
        components.of_vertex[index_of(w)] = components.count;
        stack.push_back(index_of(w));
      }
    }
    ++components.count;
  }
  return components;
}

std::int64_t euler_number(const SimplexMesh& mesh) {
  std::int64_t triangles = 0, contour_edges = 0, points = 0;
  for (std::size_t v = 0; v < mesh.face.size(); ++v) {
    if (!mesh.is_live(vertex_at(v))) continue;
    ++triangles;
    for (const SimplexVertex w : mesh.neighbour[v]) contour_edges += w == kNoVertex ? 1 : 0;
  }
  for (const std::uint32_t valence : mesh.valence) points += valence != 0 ? 1 : 0;
  return triangles - (3 * triangles + contour_edges) / 2 + points;
}

}  // namespace periost
