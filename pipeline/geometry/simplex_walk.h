#pragma once
// Walking over a simplex mesh: around a face, across an edge. Inline and O(1) unless said otherwise; elements
// passed in must be live.
#include <cstddef>

#include "pipeline/data/simplex_mesh.h"

namespace periost {

constexpr int next_slot(int slot) {
  return slot == 2 ? 0 : slot + 1;
}
constexpr int previous_slot(int slot) {
  return slot == 0 ? 2 : slot - 1;
}

// An edge of a simplex mesh, named from one of its two ends: it runs from `vertex` to
// neighbour[vertex][slot].
struct SimplexEdge {
  SimplexVertex vertex = kNoVertex;
  int slot = 0;
  friend bool operator==(const SimplexEdge&, const SimplexEdge&) = default;
};

inline SimplexVertex neighbour_of(const SimplexMesh& mesh, SimplexVertex v, int slot) {
  return mesh.neighbour[index_of(v)][static_cast<std::size_t>(slot)];
}
inline SimplexFace face_of(const SimplexMesh& mesh, SimplexVertex v, int slot) {
  return mesh.face[index_of(v)][static_cast<std::size_t>(slot)];
}
inline Vec3 position_of(const SimplexMesh& mesh, SimplexVertex v) {
  return mesh.position[index_of(v)];
}
inline std::uint32_t valence_of(const SimplexMesh& mesh, SimplexFace f) {
  return mesh.valence[index_of(f)];
}

// Where f stands among the faces of v, or -1.
inline int slot_of(const SimplexMesh& mesh, SimplexVertex v, SimplexFace f) {
  const auto& faces = mesh.face[index_of(v)];
  return faces[0] == f ? 0 : faces[1] == f ? 1 : faces[2] == f ? 2 : -1;
}
// Where w stands among the neighbours of v, or -1.
inline int slot_of(const SimplexMesh& mesh, SimplexVertex v, SimplexVertex w) {
  const auto& around = mesh.neighbour[index_of(v)];
  return around[0] == w ? 0 : around[1] == w ? 1 : around[2] == w ? 2 : -1;
}

// The vertex after v, counter-clockwise around f, or kNoVertex where the contour cuts f. Precondition: v lies
// on f.
inline SimplexVertex next_around(const SimplexMesh& mesh, SimplexVertex v, SimplexFace f) {
  return neighbour_of(mesh, v, next_slot(slot_of(mesh, v, f)));
}
inline SimplexVertex previous_around(const SimplexMesh& mesh, SimplexVertex v, SimplexFace f) {
  return neighbour_of(mesh, v, previous_slot(slot_of(mesh, v, f)));
}

// The same edge from its other end. Precondition: the edge has one (it is not on the contour).
inline SimplexEdge other_end(const SimplexMesh& mesh, SimplexEdge edge) {
  const SimplexVertex w = neighbour_of(mesh, edge.vertex, edge.slot);
  return {w, slot_of(mesh, w, edge.vertex)};
}

// True when the contour of an open surface cuts f.
inline bool is_border(const SimplexMesh& mesh, SimplexFace f) {
  return previous_around(mesh, mesh.first_vertex[index_of(f)], f) == kNoVertex;
}

// Calls visit(v) for each vertex of f, counter-clockwise from first_vertex[f]. O(valence).
template <class Visit>
void for_each_vertex(const SimplexMesh& mesh, SimplexFace f, Visit visit) {
  SimplexVertex v = mesh.first_vertex[index_of(f)];
  for (std::uint32_t i = 0; i < valence_of(mesh, f); ++i) {
    const SimplexVertex next = next_around(mesh, v, f);
    visit(v);
    v = next;
  }
}

// The mean of f's vertices, the paper's face centre. O(valence).
inline Vec3 face_centre(const SimplexMesh& mesh, SimplexFace f) {
  Vec3 sum;
  for_each_vertex(mesh, f, [&](SimplexVertex v) { sum += position_of(mesh, v); });
  return sum / static_cast<double>(valence_of(mesh, f));
}

}  // namespace periost
