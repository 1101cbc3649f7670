#pragma once
// The simplex mesh, the deformable model of the paper: every vertex has exactly three neighbours, and its
// faces are dual to the vertices of a triangulation (Delingette 1994, 1997 section 2.2).
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "pipeline/data/surface_mesh.h"

namespace periost {

// Positions in the simplex mesh's own arrays. Distinct types, so that a face cannot index vertices.
enum class SimplexVertex : std::uint32_t {};
enum class SimplexFace : std::uint32_t {};
inline constexpr SimplexVertex kNoVertex{0xFFFFFFFFu};
inline constexpr SimplexFace kNoFace{0xFFFFFFFFu};
constexpr SimplexVertex vertex_at(std::size_t i) {
  return SimplexVertex{static_cast<std::uint32_t>(i)};
}
constexpr SimplexFace face_at(std::size_t i) {
  return SimplexFace{static_cast<std::uint32_t>(i)};
}
constexpr std::uint32_t index_of(SimplexVertex v) {
  return static_cast<std::uint32_t>(v);
}
constexpr std::uint32_t index_of(SimplexFace f) {
  return static_cast<std::uint32_t>(f);
}

// What the decimator did, for the verdict. `rejected_*` count refused moves by the criterion that refused
// first.
struct DecimationReport {
  std::uint64_t triangles_before = 0;
  std::uint64_t triangles_after = 0;
  std::uint64_t removals = 0;    // T1^2
  std::uint64_t insertions = 0;  // T2^2 that mend angles; not the undoing of a removal
  std::uint64_t swaps = 0;
  std::uint64_t relocations = 0;
  std::uint32_t pieces = 1;
  double requested_distance_mm = 0;
  std::uint64_t rejected_link = 0;
  std::uint64_t rejected_topology = 0;
  std::uint64_t rejected_barycentric = 0;
  std::uint64_t rejected_angle = 0;
  std::uint64_t rejected_fold = 0;
  std::uint64_t rejected_distance = 0;
  std::uint64_t rejected_reverse = 0;
  std::uint64_t rejected_self_intersection = 0;
  std::uint64_t dropped_below = 0;  // components of fewer triangles were dropped on request

  // 1 - after/before, in 0..1.
  double rate() const {
    return triangles_before == 0
               ? 0
               : 1 - static_cast<double>(triangles_after) / static_cast<double>(triangles_before);
  }
};

// Vertex v is dual to one triangle of the triangulation, face f to one of its vertices. Seen from outside,
// neighbour[v][0..2] and face[v][0..2] run counter-clockwise, and neighbour[v][k] lies across the edge
// opposite to face[v][k]: the edge from v to neighbour[v][k] separates the other two faces of v. On an open
// surface a missing neighbour is kNoVertex, and a face cut by the contour begins its walk at first_vertex.
//
// While an algorithm edits a mesh, removed elements stay in the arrays: a dead vertex has face[v][0] ==
// kNoFace, a dead face has valence 0. compact() (geometry/simplex_dual.h) drops them; what travels between
// stages has none.
struct SimplexMesh {
  std::vector<Vec3> position;                           // of vertices, LPS mm
  std::vector<std::array<SimplexVertex, 3>> neighbour;  // of vertices
  std::vector<std::array<SimplexFace, 3>> face;         // of vertices
  std::vector<SimplexVertex> first_vertex;              // of faces: any one vertex of it; see above if open
  std::vector<std::uint32_t> valence;                   // of faces: how many vertices
  std::vector<Vec3>
      dual_position;    // of faces: the triangulation's vertex, LPS mm; `certified` guarantees its distance
  Fields face_fields;   // of faces, carried to the triangulation's points (blocking cause, provenance)
  double voxel_mm = 0;  // largest voxel side of the image behind it; 0: none
  DecimationReport report;

  bool is_live(SimplexVertex v) const { return face[index_of(v)][0] != kNoFace; }
  bool is_live(SimplexFace f) const { return valence[index_of(f)] != 0; }
};

}  // namespace periost
