#include "pipeline/geometry/simplex_operators.h"

#include <algorithm>

#include "pipeline/base/error.h"

namespace periost {
namespace {

std::size_t at(int slot) {
  return static_cast<std::size_t>(slot);
}

// The two ends of an edge with everything around it.
struct Ends {
  SimplexVertex v, w;
  int k, j;  // slots of the edge at v and at w
  EdgeFaces faces;
};

Ends ends_of(const SimplexMesh& mesh, SimplexEdge edge) {
  const SimplexEdge other = other_end(mesh, edge);
  return {edge.vertex, other.vertex, edge.slot, other.slot, faces_of(mesh, edge)};
}

// Whether an element of the edge's neighbourhood is cut by a contour.
bool touches_border(const SimplexMesh& mesh, SimplexEdge edge) {
  if (neighbour_of(mesh, edge.vertex, edge.slot) == kNoVertex) return true;
  const EdgeFaces f = faces_of(mesh, edge);
  return is_border(mesh, f.left) || is_border(mesh, f.right) || is_border(mesh, f.opposite_v) ||
         is_border(mesh, f.opposite_w);
}

// Whether faces a and b, neither cut by a contour, share an edge.
bool share_edge(const SimplexMesh& mesh, SimplexFace a, SimplexFace b) {
  bool found = false;
  for_each_vertex(mesh, a, [&](SimplexVertex v) { found = found || slot_of(mesh, v, b) >= 0; });
  return found;
}

// Faces that share an edge with both a and b.
int common_neighbours(const SimplexMesh& mesh, SimplexFace a, SimplexFace b) {
  int common = 0;
  for_each_vertex(mesh, a, [&](SimplexVertex v) {
    const SimplexFace beside = face_of(mesh, v, next_slot(slot_of(mesh, v, a)));
    if (beside != b && share_edge(mesh, b, beside)) ++common;
  });
  return common;
}

void replace(std::array<SimplexVertex, 3>& row, SimplexVertex from, SimplexVertex to) {
  *std::find(row.begin(), row.end(), from) = to;
}
void replace(std::array<SimplexFace, 3>& row, SimplexFace from, SimplexFace to) {
  *std::find(row.begin(), row.end(), from) = to;
}

// Makes a and b neighbours in place of their former neighbours (a's was `of_a`, b's was `of_b`).
void rejoin(SimplexMesh& mesh, SimplexVertex a, SimplexVertex of_a, SimplexVertex b, SimplexVertex of_b) {
  replace(mesh.neighbour[index_of(a)], of_a, b);
  replace(mesh.neighbour[index_of(b)], of_b, a);
}

// Gives the vertices from `begin` to `end`, counter-clockwise around `from`, to the face `to`.
void relabel_walk(SimplexMesh& mesh, SimplexVertex begin, SimplexVertex end, SimplexFace from,
                  SimplexFace to) {
  for (SimplexVertex x = begin;;) {
    const SimplexVertex after = next_around(mesh, x, from);
    replace(mesh.face[index_of(x)], from, to);
    if (x == end) return;
    x = after;
  }
}

std::array<SimplexVertex, 4> first_vertices(const SimplexMesh& mesh, const EdgeFaces& f) {
  const auto first = [&](SimplexFace face) { return mesh.first_vertex[index_of(face)]; };
  return {first(f.left), first(f.right), first(f.opposite_v), first(f.opposite_w)};
}

void set_first_vertices(SimplexMesh& mesh, const EdgeFaces& f, const std::array<SimplexVertex, 4>& first) {
  mesh.first_vertex[index_of(f.left)] = first[0];
  mesh.first_vertex[index_of(f.right)] = first[1];
  mesh.first_vertex[index_of(f.opposite_v)] = first[2];
  mesh.first_vertex[index_of(f.opposite_w)] = first[3];
}

void save_faces(const SimplexMesh& mesh, const EdgeFaces& f, SimplexJournal* journal) {
  for (const SimplexFace face : {f.left, f.right, f.opposite_v, f.opposite_w}) journal->save(mesh, face);
}

}  // namespace

EdgeFaces faces_of(const SimplexMesh& mesh, SimplexEdge edge) {
  const SimplexEdge other = other_end(mesh, edge);
  return {face_of(mesh, edge.vertex, next_slot(edge.slot)),
          face_of(mesh, edge.vertex, previous_slot(edge.slot)), face_of(mesh, edge.vertex, edge.slot),
          face_of(mesh, other.vertex, other.slot)};
}

int topological_criterion(const SimplexMesh& mesh, SimplexEdge edge) {
  const EdgeFaces f = faces_of(mesh, edge);
  const auto valence = [&](SimplexFace face) { return static_cast<int>(valence_of(mesh, face)); };
  return valence(f.left) + valence(f.right) - valence(f.opposite_v) - valence(f.opposite_w);
}

Legality legality_of_removal(const SimplexMesh& mesh, SimplexEdge edge) {
  if (touches_border(mesh, edge)) return Legality::kBorder;
  const EdgeFaces f = faces_of(mesh, edge);
  if (valence_of(mesh, f.opposite_v) < 4 || valence_of(mesh, f.opposite_w) < 4) return Legality::kValence;
  if (valence_of(mesh, f.left) + valence_of(mesh, f.right) < 7) return Legality::kValence;
  if (f.opposite_v == f.opposite_w || common_neighbours(mesh, f.left, f.right) != 2) return Legality::kLink;
  return Legality::kLegal;
}

Legality legality_of_swap(const SimplexMesh& mesh, SimplexEdge edge) {
  if (touches_border(mesh, edge)) return Legality::kBorder;
  const EdgeFaces f = faces_of(mesh, edge);
  if (valence_of(mesh, f.left) < 4 || valence_of(mesh, f.right) < 4) return Legality::kValence;
  if (f.opposite_v == f.opposite_w || share_edge(mesh, f.opposite_v, f.opposite_w)) return Legality::kLink;
  return Legality::kLegal;
}

void SimplexJournal::save(const SimplexMesh& mesh, SimplexVertex v) {
  const std::size_t i = index_of(v);
  vertices_.push_back({v, mesh.position[i], mesh.neighbour[i], mesh.face[i]});
}

void SimplexJournal::save(const SimplexMesh& mesh, SimplexFace f) {
  const std::size_t i = index_of(f);
  faces_.push_back({f, mesh.first_vertex[i], mesh.valence[i], mesh.dual_position[i]});
}

void SimplexJournal::undo(SimplexMesh& mesh) {
  for (auto row = vertices_.rbegin(); row != vertices_.rend(); ++row) {
    const std::size_t i = index_of(row->vertex);
    mesh.position[i] = row->position;
    mesh.neighbour[i] = row->neighbour;
    mesh.face[i] = row->face;
  }
  for (auto row = faces_.rbegin(); row != faces_.rend(); ++row) {
    const std::size_t i = index_of(row->face);
    mesh.first_vertex[i] = row->first_vertex;
    mesh.valence[i] = row->valence;
    mesh.dual_position[i] = row->dual_position;
  }
  clear();
}

void SimplexJournal::clear() {
  vertices_.clear();
  faces_.clear();
}

RemovedEdge remove_edge(SimplexMesh& mesh, SimplexEdge edge, SimplexJournal* journal) {
  PERIOST_ASSERT(legality_of_removal(mesh, edge) == Legality::kLegal);
  const auto [v, w, k, j, f] = ends_of(mesh, edge);
  const RemovedEdge removed{edge,
                            w,
                            f,
                            mesh.neighbour[index_of(v)],
                            mesh.neighbour[index_of(w)],
                            mesh.face[index_of(v)],
                            mesh.face[index_of(w)],
                            first_vertices(mesh, f),
                            valence_of(mesh, f.right)};
  const SimplexVertex v_right = neighbour_of(mesh, v, next_slot(k)),
                      v_left = neighbour_of(mesh, v, previous_slot(k));
  const SimplexVertex w_left = neighbour_of(mesh, w, next_slot(j)),
                      w_right = neighbour_of(mesh, w, previous_slot(j));
  if (journal != nullptr) {
    save_faces(mesh, f, journal);
    for (const SimplexVertex x : {v, w, v_left, w_left}) journal->save(mesh, x);
    for_each_vertex(mesh, f.right, [&](SimplexVertex x) {
      if (x != v && x != w) journal->save(mesh, x);
    });
  }
  relabel_walk(mesh, w_right, v_right, f.right, f.left);
  rejoin(mesh, v_left, v, v_right, v);
  rejoin(mesh, w_left, w, w_right, w);
  for (const SimplexVertex dead : {v, w}) {
    mesh.face[index_of(dead)] = {kNoFace, kNoFace, kNoFace};
    mesh.neighbour[index_of(dead)] = {kNoVertex, kNoVertex, kNoVertex};
  }
  mesh.valence[index_of(f.left)] += removed.right_valence - 4;
  mesh.valence[index_of(f.right)] = 0;
  --mesh.valence[index_of(f.opposite_v)];
  --mesh.valence[index_of(f.opposite_w)];
  set_first_vertices(mesh, f, {v_left, kNoVertex, v_left, w_left});
  return removed;
}

void insert_edge(SimplexMesh& mesh, const RemovedEdge& removed, SimplexJournal* journal) {
  const SimplexVertex v = removed.edge.vertex, w = removed.w;
  const int k = removed.edge.slot;
  const int j = static_cast<int>(std::find(removed.neighbour_w.begin(), removed.neighbour_w.end(), v) -
                                 removed.neighbour_w.begin());
  const EdgeFaces& f = removed.faces;
  const SimplexVertex v_right = removed.neighbour_v[at(next_slot(k))],
                      v_left = removed.neighbour_v[at(previous_slot(k))];
  const SimplexVertex w_left = removed.neighbour_w[at(next_slot(j))],
                      w_right = removed.neighbour_w[at(previous_slot(j))];
  PERIOST_ASSERT(!mesh.is_live(v) && !mesh.is_live(w) && slot_of(mesh, v_left, v_right) >= 0 &&
                 slot_of(mesh, w_left, w_right) >= 0);
  if (journal != nullptr) {
    save_faces(mesh, f, journal);
    journal->save(mesh, v);
    journal->save(mesh, w);
    for_each_vertex(mesh, f.left, [&](SimplexVertex x) { journal->save(mesh, x); });
  }
  relabel_walk(mesh, w_right, v_right, f.left, f.right);
  mesh.neighbour[index_of(v)] = removed.neighbour_v;
  mesh.neighbour[index_of(w)] = removed.neighbour_w;
  mesh.face[index_of(v)] = removed.face_v;
  mesh.face[index_of(w)] = removed.face_w;
  replace(mesh.neighbour[index_of(v_left)], v_right, v);
  replace(mesh.neighbour[index_of(v_right)], v_left, v);
  replace(mesh.neighbour[index_of(w_left)], w_right, w);
  replace(mesh.neighbour[index_of(w_right)], w_left, w);
  mesh.valence[index_of(f.right)] = removed.right_valence;
  mesh.valence[index_of(f.left)] -= removed.right_valence - 4;
  ++mesh.valence[index_of(f.opposite_v)];
  ++mesh.valence[index_of(f.opposite_w)];
  set_first_vertices(mesh, f, removed.first);
}

SwappedEdge swap_edge(SimplexMesh& mesh, SimplexEdge edge, SimplexJournal* journal) {
  PERIOST_ASSERT(legality_of_swap(mesh, edge) == Legality::kLegal);
  const auto [v, w, k, j, f] = ends_of(mesh, edge);
  const SwappedEdge swapped{{v, next_slot(k)}, f, first_vertices(mesh, f)};
  const SimplexVertex v_right = neighbour_of(mesh, v, next_slot(k)),
                      v_left = neighbour_of(mesh, v, previous_slot(k));
  const SimplexVertex w_left = neighbour_of(mesh, w, next_slot(j)),
                      w_right = neighbour_of(mesh, w, previous_slot(j));
  if (journal != nullptr) {
    save_faces(mesh, f, journal);
    for (const SimplexVertex x : {v, w, v_right, w_left}) journal->save(mesh, x);
  }
  auto& around_v = mesh.neighbour[index_of(v)];
  auto& around_w = mesh.neighbour[index_of(w)];
  around_v[at(k)] = w_left;
  around_v[at(next_slot(k))] = w;
  around_v[at(previous_slot(k))] = v_left;
  around_w[at(j)] = v_right;
  around_w[at(next_slot(j))] = v;
  around_w[at(previous_slot(j))] = w_right;
  mesh.face[index_of(v)][at(previous_slot(k))] = f.opposite_w;
  mesh.face[index_of(w)][at(previous_slot(j))] = f.opposite_v;
  replace(mesh.neighbour[index_of(v_right)], v, w);
  replace(mesh.neighbour[index_of(w_left)], w, v);
  --mesh.valence[index_of(f.left)];
  --mesh.valence[index_of(f.right)];
  ++mesh.valence[index_of(f.opposite_v)];
  ++mesh.valence[index_of(f.opposite_w)];
  set_first_vertices(mesh, f, {v, w, v, w});
  return swapped;
}

void swap_back(SimplexMesh& mesh, const SwappedEdge& swapped, SimplexJournal* journal) {
  const EdgeFaces& f = swapped.faces;
  const SimplexVertex v = swapped.edge.vertex, w = neighbour_of(mesh, v, swapped.edge.slot);
  const int k = previous_slot(swapped.edge.slot), j = previous_slot(slot_of(mesh, w, v));
  const SimplexVertex w_left = neighbour_of(mesh, v, k), v_left = neighbour_of(mesh, v, previous_slot(k));
  const SimplexVertex v_right = neighbour_of(mesh, w, j), w_right = neighbour_of(mesh, w, previous_slot(j));
  PERIOST_ASSERT(face_of(mesh, v, next_slot(k)) == f.left && face_of(mesh, w, next_slot(j)) == f.right);
  if (journal != nullptr) {
    save_faces(mesh, f, journal);
    for (const SimplexVertex x : {v, w, v_right, w_left}) journal->save(mesh, x);
  }
  auto& around_v = mesh.neighbour[index_of(v)];
  auto& around_w = mesh.neighbour[index_of(w)];
  around_v[at(k)] = w;
  around_v[at(next_slot(k))] = v_right;
  around_v[at(previous_slot(k))] = v_left;
  around_w[at(j)] = v;
  around_w[at(next_slot(j))] = w_left;
  around_w[at(previous_slot(j))] = w_right;
  mesh.face[index_of(v)][at(previous_slot(k))] = f.right;
  mesh.face[index_of(w)][at(previous_slot(j))] = f.left;
  replace(mesh.neighbour[index_of(v_right)], w, v);
  replace(mesh.neighbour[index_of(w_left)], v, w);
  ++mesh.valence[index_of(f.left)];
  ++mesh.valence[index_of(f.right)];
  --mesh.valence[index_of(f.opposite_v)];
  --mesh.valence[index_of(f.opposite_w)];
  set_first_vertices(mesh, f, swapped.first);
}

}  // namespace periost
