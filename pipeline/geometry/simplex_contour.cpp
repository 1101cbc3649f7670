#include "pipeline/geometry/simplex_contour.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "pipeline/base/error.h"
#include "pipeline/geometry/simplex_dual.h"

namespace periost {
namespace {

// The border plane that both points lie on.
std::uint8_t side_of(const GridFrame& frame, Vec3 p, Vec3 q) {
  const Vec3 a = frame.to_index(p), b = frame.to_index(q);
  for (std::uint8_t side = 0; side < kFixedContour; ++side) {
    const std::size_t axis = side / 2;
    if (frame.dims[axis] < 2) continue;
    const double plane = side % 2 == 0 ? 0 : frame.dims[axis] - 1;
    if (std::abs(a[axis] - plane) < 1e-6 && std::abs(b[axis] - plane) < 1e-6) return side;
  }
  return kFixedContour;
}

// Gives every cycle of contour vertices a face of its own.
void add_holes(SimplexMesh& mesh, Contours& contours) {
  contours.is_hole.resize(mesh.valence.size(), 0);
  for (std::size_t i = 0; i < mesh.face.size(); ++i) {
    if (contours.side[i] == kInside || !mesh.is_live(vertex_at(i))) continue;
    if (mesh.face[i][kHoleSlot] != kNoFace) continue;
    const SimplexFace hole = face_at(mesh.valence.size());
    std::uint32_t length = 0;
    for (SimplexVertex v = vertex_at(i); mesh.face[index_of(v)][kHoleSlot] == kNoFace;
         v = mesh.neighbour[index_of(v)][0]) {
      mesh.face[index_of(v)][kHoleSlot] = hole;
      ++length;
    }
    mesh.first_vertex.push_back(vertex_at(i));
    mesh.valence.push_back(length);
    mesh.dual_position.push_back(mesh.position[i]);
    contours.is_hole.push_back(1);
  }
  for (auto& [name, values] : mesh.face_fields) values.resize(mesh.valence.size(), 0);
  contours.may_be_cut.assign(mesh.valence.size(), 0);
  for (std::size_t i = 0; i < mesh.face.size(); ++i) {
    if (contours.side[i] == kInside || !mesh.is_live(vertex_at(i))) continue;
    for (const std::size_t k : {0u, 1u}) contours.may_be_cut[index_of(mesh.face[i][k])] = 1;
  }
}

void append(SimplexMesh& mesh, const SimplexMesh& part) {
  const auto vertices = static_cast<std::uint32_t>(mesh.face.size()),
             faces = static_cast<std::uint32_t>(mesh.valence.size());
  mesh.position.insert(mesh.position.end(), part.position.begin(), part.position.end());
  mesh.valence.insert(mesh.valence.end(), part.valence.begin(), part.valence.end());
  mesh.dual_position.insert(mesh.dual_position.end(), part.dual_position.begin(), part.dual_position.end());
  for (auto row : part.neighbour) {
    for (SimplexVertex& v : row) v = v == kNoVertex ? v : vertex_at(index_of(v) + vertices);
    mesh.neighbour.push_back(row);
  }
  for (auto row : part.face) {
    for (SimplexFace& f : row) f = face_at(index_of(f) + faces);
    mesh.face.push_back(row);
  }
  for (const SimplexVertex v : part.first_vertex)
    mesh.first_vertex.push_back(vertex_at(index_of(v) + vertices));
}

// A contour vertex with the places that its border edge joins, lower first.
struct BorderEdge {
  std::array<Vec3, 2> ends;
  SimplexVertex vertex;
};

bool is_less(Vec3 a, Vec3 b) {
  return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
}

std::vector<BorderEdge> fixed_edges(const ContouredMesh& part) {
  std::vector<BorderEdge> edges;
  for (std::size_t i = 0; i < part.contours.side.size(); ++i) {
    if (part.contours.side[i] != kFixedContour) continue;
    Vec3 a = part.mesh.dual_position[index_of(part.mesh.face[i][0])],
         b = part.mesh.dual_position[index_of(part.mesh.face[i][1])];
    if (is_less(b, a)) std::swap(a, b);
    edges.push_back({{a, b}, vertex_at(i)});
  }
  std::sort(edges.begin(), edges.end(), [](const BorderEdge& x, const BorderEdge& y) {
    if (x.ends[0] != y.ends[0]) return is_less(x.ends[0], y.ends[0]);
    if (x.ends[1] != y.ends[1]) return is_less(x.ends[1], y.ends[1]);
    return x.vertex < y.vertex;
  });
  return edges;
}

// Makes `to` the neighbour of v where it was `from`.
void reconnect(SimplexMesh& mesh, SimplexVertex v, SimplexVertex from, SimplexVertex to) {
  auto& row = mesh.neighbour[index_of(v)];
  *std::find(row.begin(), row.end(), from) = to;
}

// The face that f has become; paths are as long as a point has parts, two.
SimplexFace merged(const std::vector<SimplexFace>& into, SimplexFace f) {
  while (into[index_of(f)] != f) f = into[index_of(f)];
  return f;
}

// Two contour vertices of the same border edge, seen from either part: they run opposite ways, so what
// follows one precedes the other.
void join_pair(SewnMesh& sewn, const std::vector<SimplexVertex>& mate, std::vector<SimplexFace>& into,
               SimplexVertex a, SimplexVertex b) {
  SimplexMesh& mesh = sewn.whole.mesh;
  const auto row_a = mesh.neighbour[index_of(a)], row_b = mesh.neighbour[index_of(b)];
  const auto faces_a = mesh.face[index_of(a)], faces_b = mesh.face[index_of(b)];
  reconnect(mesh, row_a[kHoleSlot], a, row_b[kHoleSlot]);
  reconnect(mesh, row_b[kHoleSlot], b, row_a[kHoleSlot]);
  sewn.seam.push_back(row_a[kHoleSlot]);
  sewn.seam.push_back(row_b[kHoleSlot]);
  for (const std::size_t k : {0u, 1u}) {
    const SimplexFace p = merged(into, faces_a[k]), q = merged(into, faces_b[1 - k]);
    into[index_of(std::max(p, q))] = std::min(p, q);
    // The contour goes on from one part to the other where the cut ends.
    const SimplexVertex x = row_a[k], y = row_b[1 - k];
    if (mate[index_of(x)] != kNoVertex || mate[index_of(y)] != kNoVertex) continue;
    mesh.neighbour[index_of(x)][1 - k] = y;
    mesh.neighbour[index_of(y)][k] = x;
  }
}

void kill(SimplexMesh& mesh, SimplexVertex v) {
  mesh.face[index_of(v)] = {kNoFace, kNoFace, kNoFace};
  mesh.neighbour[index_of(v)] = {kNoVertex, kNoVertex, kNoVertex};
}

// Valences and first vertices anew, from the faces that the vertices name.
void recount_faces(SimplexMesh& mesh) {
  std::fill(mesh.valence.begin(), mesh.valence.end(), 0u);
  for (std::size_t i = 0; i < mesh.face.size(); ++i) {
    for (const SimplexFace f : mesh.face[i]) {
      if (f != kNoFace && mesh.valence[index_of(f)]++ == 0) mesh.first_vertex[index_of(f)] = vertex_at(i);
    }
  }
}

// The seam's vertices once each, ascending, by the numbers they will have when dead vertices are gone.
void number_seam(SewnMesh& sewn) {
  std::vector<std::uint8_t> is_seam(sewn.whole.mesh.face.size(), 0);
  for (const SimplexVertex v : sewn.seam) is_seam[index_of(v)] = 1;
  sewn.seam.clear();
  std::size_t number = 0;
  for (std::size_t i = 0; i < is_seam.size(); ++i) {
    if (is_seam[i] != 0) sewn.seam.push_back(vertex_at(number));
    if (sewn.whole.mesh.is_live(vertex_at(i))) ++number;
  }
}

}  // namespace

Contours close_contours(SimplexMesh& mesh, const GridFrame& frame) {
  Contours contours;
  const std::size_t inner = mesh.face.size(), faces = mesh.valence.size();
  // The contour vertices of the border edges that follow and precede a border face's fan.
  std::vector<SimplexVertex> after(faces, kNoVertex), before(faces, kNoVertex);
  for (std::size_t i = 0; i < inner; ++i) {
    for (int k = 0; k < 3; ++k) {
      if (mesh.neighbour[i][static_cast<std::size_t>(k)] != kNoVertex) continue;
      const SimplexVertex v = vertex_at(mesh.face.size());
      const SimplexFace p = face_of(mesh, vertex_at(i), next_slot(k)),
                        q = face_of(mesh, vertex_at(i), previous_slot(k));
      const Vec3 at_p = mesh.dual_position[index_of(p)], at_q = mesh.dual_position[index_of(q)];
      mesh.neighbour[i][static_cast<std::size_t>(k)] = v;
      mesh.position.push_back(0.5 * (at_p + at_q));
      mesh.face.push_back({q, p, kNoFace});
      mesh.neighbour.push_back({kNoVertex, kNoVertex, vertex_at(i)});
      if (contours.empty()) contours.side.assign(inner, kInside);
      contours.side.push_back(side_of(frame, at_p, at_q));
      after[index_of(q)] = before[index_of(p)] = v;
      ++mesh.valence[index_of(p)];
      ++mesh.valence[index_of(q)];
    }
  }
  for (std::size_t i = inner; i < mesh.face.size(); ++i) {
    mesh.neighbour[i][0] = after[index_of(mesh.face[i][1])];
    mesh.neighbour[i][1] = before[index_of(mesh.face[i][0])];
  }
  if (!contours.empty()) add_holes(mesh, contours);
  return contours;
}

void open_contours(SimplexMesh& mesh, const Contours& contours) {
  for (std::size_t i = 0; i < contours.side.size(); ++i) {
    const SimplexVertex v = vertex_at(i);
    if (contours.side[i] == kInside || !mesh.is_live(v)) continue;
    const SimplexVertex inner = mesh.neighbour[i][kHoleSlot];
    reconnect(mesh, inner, v, kNoVertex);
    for (const std::size_t k : {0u, 1u}) --mesh.valence[index_of(mesh.face[i][k])];
    mesh.valence[index_of(mesh.face[i][kHoleSlot])] = 0;
    mesh.first_vertex[index_of(mesh.face[i][1])] = inner;
    kill(mesh, v);
  }
}

void compact(SimplexMesh& mesh, Contours& contours) {
  if (!contours.empty()) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < mesh.face.size(); ++i) {
      if (mesh.is_live(vertex_at(i))) contours.side[kept++] = contours.side[i];
    }
    contours.side.resize(kept);
    kept = 0;
    for (std::size_t f = 0; f < mesh.valence.size(); ++f) {
      if (!mesh.is_live(face_at(f))) continue;
      contours.may_be_cut[kept] = contours.may_be_cut[f];
      contours.is_hole[kept++] = contours.is_hole[f];
    }
    contours.is_hole.resize(kept);
    contours.may_be_cut.resize(kept);
  }
  compact(mesh);
}

ContourEdge contour_edge_of(const SimplexMesh& mesh, const Contours& contours, SimplexFace f) {
  ContourEdge edge;
  if (contours.empty() || contours.may_be_cut[index_of(f)] == 0) return edge;
  for_each_vertex(mesh, f, [&](SimplexVertex v) {
    if (contours.side[index_of(v)] == kInside) return;
    // Around its face 1 a contour vertex is followed by its inner neighbour, around its face 0 preceded.
    (mesh.face[index_of(v)][1] == f ? edge.second : edge.first) = v;
  });
  return edge;
}

SewnMesh sew(const std::vector<ContouredMesh>& parts) {
  SewnMesh sewn;
  SimplexMesh& mesh = sewn.whole.mesh;
  Contours& contours = sewn.whole.contours;
  for (const ContouredMesh& part : parts) {
    contours.side.resize(mesh.face.size(), kInside);
    append(mesh, part.mesh);
    contours.side.insert(contours.side.end(), part.contours.side.begin(), part.contours.side.end());
    mesh.voxel_mm = part.mesh.voxel_mm;
  }
  contours.side.resize(mesh.face.size(), kInside);

  const std::vector<BorderEdge> edges = fixed_edges(sewn.whole);
  std::vector<SimplexVertex> mate(mesh.face.size(), kNoVertex);
  for (std::size_t e = 1; e < edges.size(); ++e) {
    if (edges[e].ends != edges[e - 1].ends) continue;
    mate[index_of(edges[e].vertex)] = edges[e - 1].vertex;
    mate[index_of(edges[e - 1].vertex)] = edges[e].vertex;
  }
  std::vector<SimplexFace> into(mesh.valence.size());
  for (std::size_t f = 0; f < into.size(); ++f) into[f] = face_at(f);
  for (std::size_t i = 0; i < mate.size(); ++i) {
    if (mate[i] != kNoVertex && vertex_at(i) < mate[i]) join_pair(sewn, mate, into, vertex_at(i), mate[i]);
  }
  for (std::size_t i = 0; i < mate.size(); ++i) {
    if (mate[i] != kNoVertex) kill(mesh, vertex_at(i));
    for (SimplexFace& f : mesh.face[i]) f = f == kNoFace ? f : merged(into, f);
    if (mesh.is_live(vertex_at(i)) && contours.side[i] != kInside) mesh.face[i][kHoleSlot] = kNoFace;
  }
  recount_faces(mesh);
  bool has_contours = false;
  for (std::size_t i = 0; i < mate.size(); ++i)
    has_contours = has_contours || (contours.side[i] != kInside && mesh.is_live(vertex_at(i)));
  if (has_contours) {
    add_holes(mesh, contours);
  } else {
    contours = {};
  }
  number_seam(sewn);
  compact(mesh, contours);
  return sewn;
}

}  // namespace periost
