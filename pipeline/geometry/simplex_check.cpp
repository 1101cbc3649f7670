// check_simplex_mesh: the invariants of geometry/simplex_dual.h, one after the other.
#include <fmt/format.h>

#include <algorithm>

#include "pipeline/geometry/simplex_dual.h"
#include "pipeline/geometry/simplex_walk.h"

namespace periost {
namespace {

std::string check_sizes(const SimplexMesh& mesh) {
  const std::size_t vertices = mesh.position.size(), faces = mesh.valence.size();
  if (mesh.neighbour.size() != vertices || mesh.face.size() != vertices)
    return "vertex arrays differ in size";
  if (mesh.first_vertex.size() != faces || mesh.dual_position.size() != faces)
    return "face arrays differ in size";
  for (const auto& [name, values] : mesh.face_fields) {
    if (values.size() != faces)
      return fmt::format("face field '{}' has {} values for {} faces", name, values.size(), faces);
  }
  return {};
}

std::string check_faces_of(const SimplexMesh& mesh, SimplexVertex v) {
  const auto& faces = mesh.face[index_of(v)];
  for (const SimplexFace f : faces) {
    if (index_of(f) >= mesh.valence.size()) return fmt::format("vertex {} names no face", index_of(v));
    if (!mesh.is_live(f)) return fmt::format("vertex {} names the dead face {}", index_of(v), index_of(f));
  }
  if (faces[0] == faces[1] || faces[1] == faces[2] || faces[2] == faces[0]) {
    return fmt::format("vertex {} has a face twice", index_of(v));
  }
  return {};
}

std::string check_neighbours_of(const SimplexMesh& mesh, SimplexVertex v) {
  const auto& around = mesh.neighbour[index_of(v)];
  for (int k = 0; k < 3; ++k) {
    const SimplexVertex w = around[static_cast<std::size_t>(k)];
    if (w == kNoVertex) continue;
    if (index_of(w) >= mesh.face.size() || w == v || !mesh.is_live(w)) {
      return fmt::format("vertex {} has the impossible neighbour {}", index_of(v), index_of(w));
    }
    if (w == neighbour_of(mesh, v, next_slot(k)))
      return fmt::format("vertex {} has neighbour {} twice", index_of(v), index_of(w));
    const int j = slot_of(mesh, w, v);
    if (j < 0) return fmt::format("vertices {} and {} are not mutual neighbours", index_of(v), index_of(w));
    if (face_of(mesh, w, next_slot(j)) != face_of(mesh, v, previous_slot(k)) ||
        face_of(mesh, w, previous_slot(j)) != face_of(mesh, v, next_slot(k))) {
      return fmt::format("the ends {} and {} of an edge see other faces beside it", index_of(v), index_of(w));
    }
  }
  return {};
}

std::string check_walk(const SimplexMesh& mesh, SimplexFace f, std::uint32_t incidences) {
  const SimplexVertex first = mesh.first_vertex[index_of(f)];
  if (index_of(first) >= mesh.face.size() || !mesh.is_live(first) || slot_of(mesh, first, f) < 0) {
    return fmt::format("face {} begins at a vertex that is not its own", index_of(f));
  }
  const bool border = is_border(mesh, f);
  SimplexVertex v = first;
  std::uint32_t length = 0;
  do {
    ++length;
    v = next_around(mesh, v, f);
  } while (v != kNoVertex && v != first && length <= incidences);
  if (length != mesh.valence[index_of(f)] || length != incidences || (v == kNoVertex) != border) {
    return fmt::format("face {} has valence {}, walk {} and {} vertices", index_of(f),
                       mesh.valence[index_of(f)], length, incidences);
  }
  if (!border && length < 3) return fmt::format("face {} has {} vertices", index_of(f), length);
  return {};
}

// Two faces that share two edges would be two triangulation edges between the same two points.
std::string check_shared_edges(const SimplexMesh& mesh) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (std::size_t i = 0; i < mesh.face.size(); ++i) {
    const SimplexVertex v{static_cast<std::uint32_t>(i)};
    if (!mesh.is_live(v)) continue;
    for (int k = 0; k < 3; ++k) {
      const SimplexVertex w = neighbour_of(mesh, v, k);
      if (w != kNoVertex && w < v) continue;
      const auto a = index_of(face_of(mesh, v, next_slot(k))),
                 b = index_of(face_of(mesh, v, previous_slot(k)));
      pairs.emplace_back(std::min(a, b), std::max(a, b));
    }
  }
  std::sort(pairs.begin(), pairs.end());
  const auto twice = std::adjacent_find(pairs.begin(), pairs.end());
  return twice == pairs.end() ? std::string()
                              : fmt::format("faces {} and {} share two edges", twice->first, twice->second);
}

}  // namespace

std::string check_simplex_mesh(const SimplexMesh& mesh) {
  if (std::string text = check_sizes(mesh); !text.empty()) return text;
  std::vector<std::uint32_t> incidences(mesh.valence.size(), 0);
  for (std::size_t i = 0; i < mesh.face.size(); ++i) {
    const SimplexVertex v{static_cast<std::uint32_t>(i)};
    if (!mesh.is_live(v)) continue;
    if (std::string text = check_faces_of(mesh, v); !text.empty()) return text;
    for (const SimplexFace f : mesh.face[i]) ++incidences[index_of(f)];
  }
  for (std::size_t i = 0; i < mesh.face.size(); ++i) {
    const SimplexVertex v{static_cast<std::uint32_t>(i)};
    if (!mesh.is_live(v)) continue;
    if (std::string text = check_neighbours_of(mesh, v); !text.empty()) return text;
  }
  for (std::size_t i = 0; i < mesh.valence.size(); ++i) {
    const SimplexFace f{static_cast<std::uint32_t>(i)};
    if (!mesh.is_live(f)) continue;
    if (std::string text = check_walk(mesh, f, incidences[i]); !text.empty()) return text;
  }
  return check_shared_edges(mesh);
}

}  // namespace periost
