#include "stages/decimate/certified_mesh.h"

#include <algorithm>

#include "pipeline/base/error.h"

namespace periost {
namespace {

// Rotates a star so that `triangle` comes first.
void rotate_to(Index triangle, Star& star, Star& rotated) {
  const std::size_t count = star.triangle.size();
  std::size_t start = 0;
  while (star.triangle[start] != triangle) ++start;
  rotated.triangle.clear();
  rotated.link.clear();
  for (std::size_t i = 0; i < count; ++i) {
    rotated.triangle.push_back(star.triangle[(start + i) % count]);
    rotated.link.push_back(star.link[(start + i) % count]);
  }
}

// Fills the proposal's fan around `apex` from the outer triangles' links.
void set_fan(const CertifiedMesh& mesh, Index apex, const FixedList<Index, kMaxRing>& fan,
             const FixedList<Index, kMaxRing>& old_apex, Proposal& proposal) {
  const std::size_t count = fan.size();
  for (std::size_t i = 0; i < count; ++i) {
    const Index id = fan[i];
    const Index a = proposal.rim[i], b = proposal.rim[(i + 1) % count];
    const LinkedTriangle& old = mesh.triangles[id];
    proposal.after.push_back(id);
    proposal.cells.push_back(
        {{apex, a, b},
         {old.across[old.slot_of(old_apex[i])], fan[(i + 1) % count], fan[(i + count - 1) % count]}});
  }
}

// The triangles of a star but its first and last, with their leading link vertices.
void append_survivors(const Star& star, Index apex, FixedList<Index, kMaxRing>& fan,
                      FixedList<Index, kMaxRing>& old_apex, Proposal& proposal) {
  for (std::size_t i = 1; i + 1 < star.triangle.size(); ++i) {
    fan.push_back(star.triangle[i]);
    old_apex.push_back(apex);
    proposal.rim.push_back(star.link[i]);
  }
}

// Makes the first triangle of a contour point's fan its incident one.
void rewind(CertifiedMesh& mesh, Index vertex) {
  const Index start = mesh.incident[vertex];
  for (Index t = start;;) {
    mesh.incident[vertex] = t;
    const LinkedTriangle& triangle = mesh.triangles[t];
    t = triangle.across[(triangle.slot_of(vertex) + 2) % 3];
    if (t == kNoIndex || t == start) return;
  }
}

// Fans and valences of contour points; one with more triangles than its fan has joins several, and is locked.
void prepare_contours(CertifiedMesh& mesh) {
  for (Index v = 0; v < mesh.points.size(); ++v) {
    if (!mesh.is_on_contour(v)) continue;
    rewind(mesh, v);
    std::size_t fan = 0;
    for (Index t = mesh.incident[v]; t != kNoIndex; ++fan) {
      const LinkedTriangle& triangle = mesh.triangles[t];
      t = triangle.across[(triangle.slot_of(v) + 1) % 3];
    }
    if (fan != mesh.valence[v]) mesh.is_locked[v] = 1;
    mesh.valence[v] = static_cast<std::uint8_t>(std::min(255, mesh.valence[v] + 3));
  }
}

}  // namespace

CertifiedMesh make_certified_mesh(const Reference& reference) {
  CertifiedMesh mesh;
  mesh.triangles = reference.triangles;
  mesh.points = reference.points;
  const std::size_t count = mesh.points.size();
  mesh.nearest.assign(count, kNoIndex);
  mesh.valence.assign(count, 0);
  mesh.is_locked.assign(count, 0);
  mesh.version.assign(count, 1);
  const bool is_open = std::any_of(mesh.triangles.begin(), mesh.triangles.end(), [](const LinkedTriangle& t) {
    return t.across[0] == kNoIndex || t.across[1] == kNoIndex || t.across[2] == kNoIndex;
  });
  if (is_open) mesh.contour.assign(count, kOffContour);
  for (Index t = 0; t < mesh.triangles.size(); ++t) {
    const auto& triangle = mesh.triangles[t];
    for (std::size_t k = 0; k < 3; ++k) {
      const Index v = triangle.corner[k];
      if (mesh.nearest[v] == kNoIndex) mesh.nearest[v] = t;
      if (mesh.valence[v] < 255) ++mesh.valence[v];
      if (triangle.across[k] != kNoIndex) continue;
      mesh.contour[triangle.corner[(k + 1) % 3]] = kOnContour;
      mesh.contour[triangle.corner[(k + 2) % 3]] = kOnContour;
    }
  }
  mesh.incident = mesh.nearest;
  if (is_open) prepare_contours(mesh);
  return mesh;
}

bool gather_ring(const CertifiedMesh& mesh, Index vertex, Star& ring) {
  if (gather_star(mesh, vertex, ring)) return true;
  if (!mesh.is_on_contour(vertex) || ring.link.is_full()) return false;
  const LinkedTriangle& last = mesh.triangles[ring.triangle[ring.triangle.size() - 1]];
  ring.link.push_back(last.corner[(last.slot_of(vertex) + 2) % 3]);
  return true;
}

bool gather_star(const CertifiedMesh& mesh, Index vertex, Star& star) {
  star.triangle.clear();
  star.link.clear();
  const Index first = mesh.incident[vertex];
  Index t = first;
  do {
    if (star.triangle.is_full()) return false;
    const LinkedTriangle& triangle = mesh.triangles[t];
    const std::size_t k = triangle.slot_of(vertex);
    star.triangle.push_back(t);
    star.link.push_back(triangle.corner[(k + 1) % 3]);
    t = triangle.across[(k + 1) % 3];
    if (t == kNoIndex) return false;
  } while (t != first);
  return true;
}

bool is_any_locked(const CertifiedMesh& mesh, const FixedList<Index, kMaxStar>& link) {
  return std::any_of(link.begin(), link.end(), [&](Index v) { return mesh.is_locked[v] != 0; });
}

bool propose_removal(const CertifiedMesh& mesh, Index triangle, std::size_t k, Proposal& proposal) {
  proposal.begin(MoveKind::kRemoval);
  const LinkedTriangle& first = mesh.triangles[triangle];
  const Index u = first.corner[(k + 1) % 3], v = first.corner[(k + 2) % 3];
  const Index other = first.across[k];
  if (other == kNoIndex || mesh.is_locked[u] || mesh.is_locked[v]) return false;
  Star gathered, star_u, star_v;
  if (!gather_star(mesh, u, gathered)) return false;
  rotate_to(triangle, gathered, star_u);  // (u, v, a) first, (u, b, v) last
  if (!gather_star(mesh, v, gathered)) return false;
  rotate_to(other, gathered, star_v);  // (v, u, b) first, (v, a, u) last
  if (is_any_locked(mesh, star_u.link) || is_any_locked(mesh, star_v.link)) return false;
  const std::size_t nu = star_u.triangle.size(), nv = star_v.triangle.size();
  if (nu + nv < 7) return false;  // the merged vertex keeps three triangles
  const Index a = star_u.link[1], b = star_u.link[nu - 1];
  for (const Index x : star_u.link) {
    if (x != a && x != b && star_v.link.contains(x)) return false;
  }
  if (a == b || mesh.valence[a] <= 3 || mesh.valence[b] <= 3) return false;
  for (const Index t : star_u.triangle) proposal.before.push_back(t);
  for (std::size_t i = 1; i + 1 < nv; ++i) proposal.before.push_back(star_v.triangle[i]);
  FixedList<Index, kMaxRing> fan, old_apex;
  append_survivors(star_u, u, fan, old_apex, proposal);
  append_survivors(star_v, v, fan, old_apex, proposal);
  set_fan(mesh, u, fan, old_apex, proposal);
  proposal.moved = u;
  proposal.removed = v;
  proposal.valence_changes.push_back({u, static_cast<int>(nv) - 4});
  proposal.valence_changes.push_back({a, -1});
  proposal.valence_changes.push_back({b, -1});
  return true;
}

bool makes_neck(const CertifiedMesh& mesh, const Proposal& proposal) {
  Star of_moved, of_removed, of_rim;
  if (!gather_star(mesh, proposal.moved, of_moved) || !gather_star(mesh, proposal.removed, of_removed)) {
    return false;
  }
  // The third edge of a new cycle leads from a neighbour of one end only to one of the other only.
  for (const Index a : of_moved.link) {
    if (a == proposal.removed || of_removed.link.contains(a) || !gather_ring(mesh, a, of_rim)) continue;
    for (const Index b : of_rim.link) {
      if (b != proposal.moved && of_removed.link.contains(b) && !of_moved.link.contains(b)) return true;
    }
  }
  return false;
}

bool propose_swap(const CertifiedMesh& mesh, Index triangle, std::size_t k, Proposal& proposal) {
  proposal.begin(MoveKind::kSwap);
  const LinkedTriangle& first = mesh.triangles[triangle];
  const Index a = first.corner[k], u = first.corner[(k + 1) % 3], v = first.corner[(k + 2) % 3];
  const Index other = first.across[k];
  if (other == kNoIndex || mesh.valence[u] <= 3 || mesh.valence[v] <= 3) return false;
  const LinkedTriangle& second = mesh.triangles[other];
  const std::size_t slot_u = second.slot_of(u), slot_v = second.slot_of(v);
  const Index b = second.corner[3 - slot_u - slot_v];
  if (a == b || mesh.is_locked[u] || mesh.is_locked[v] || mesh.is_locked[a] || mesh.is_locked[b])
    return false;
  Star star;
  if (!gather_ring(mesh, a, star) || star.link.contains(b)) return false;
  for (const Index t : {triangle, other}) {
    proposal.before.push_back(t);
    proposal.after.push_back(t);
  }
  proposal.cells.push_back({{u, b, a}, {other, first.across[(k + 2) % 3], second.across[slot_v]}});
  proposal.cells.push_back({{b, v, a}, {first.across[(k + 1) % 3], triangle, second.across[slot_u]}});
  for (const Index x : {u, b, v, a}) proposal.rim.push_back(x);
  proposal.valence_changes.push_back({u, -1});
  proposal.valence_changes.push_back({v, -1});
  proposal.valence_changes.push_back({a, 1});
  proposal.valence_changes.push_back({b, 1});
  return true;
}

bool propose_insertion(const CertifiedMesh& mesh, Index triangle, std::size_t k, Index vertex,
                       const std::array<Index, 2>& triangles, Proposal& proposal) {
  proposal.begin(MoveKind::kInsertion);
  const LinkedTriangle& first = mesh.triangles[triangle];
  const Index a = first.corner[k], u = first.corner[(k + 1) % 3], v = first.corner[(k + 2) % 3];
  const Index other = first.across[k];
  if (other == kNoIndex) return false;
  const LinkedTriangle& second = mesh.triangles[other];
  const std::size_t slot_u = second.slot_of(u), slot_v = second.slot_of(v);
  const Index b = second.corner[3 - slot_u - slot_v];
  const auto [beside_first, beside_second] = triangles;
  for (const Index x : {u, b, v, a}) {
    if (mesh.is_locked[x]) return false;
    proposal.rim.push_back(x);
  }
  for (const Index t : {triangle, other}) proposal.before.push_back(t);
  for (const Index t : {triangle, beside_first, other, beside_second}) proposal.after.push_back(t);
  proposal.cells.push_back({{a, u, vertex}, {other, beside_first, first.across[(k + 2) % 3]}});
  proposal.cells.push_back({{a, vertex, v}, {beside_second, first.across[(k + 1) % 3], triangle}});
  proposal.cells.push_back({{b, vertex, u}, {triangle, second.across[slot_v], beside_second}});
  proposal.cells.push_back({{b, v, vertex}, {beside_first, other, second.across[slot_u]}});
  proposal.moved = vertex;
  proposal.valence_changes.push_back({vertex, 4});
  proposal.valence_changes.push_back({a, 1});
  proposal.valence_changes.push_back({b, 1});
  return true;
}

bool propose_relocation(const CertifiedMesh& mesh, Index vertex, Proposal& proposal) {
  proposal.begin(MoveKind::kRelocation);
  Star star;
  if (mesh.is_locked[vertex] || !gather_star(mesh, vertex, star) || is_any_locked(mesh, star.link))
    return false;
  for (std::size_t i = 0; i < star.triangle.size(); ++i) {
    const Index t = star.triangle[i];
    proposal.before.push_back(t);
    proposal.after.push_back(t);
    proposal.cells.push_back(mesh.triangles[t]);
    proposal.rim.push_back(star.link[i]);
  }
  proposal.moved = vertex;
  return true;
}

void apply(const Proposal& proposal, CertifiedMesh& mesh) {
  for (const Index t : proposal.before) mesh.triangles[t].corner[0] = kNoIndex;
  for (std::size_t i = 0; i < proposal.after.size(); ++i) {
    const Index id = proposal.after[i];
    const LinkedTriangle& cell = proposal.cells[i];
    mesh.triangles[id] = cell;
    for (std::size_t k = 0; k < 3; ++k) mesh.incident[cell.corner[k]] = id;
  }
  // Triangles outside point back at the new ones.
  for (std::size_t i = 0; i < proposal.after.size(); ++i) {
    const LinkedTriangle& cell = proposal.cells[i];
    for (std::size_t k = 0; k < 3; ++k) {
      if (cell.across[k] == kNoIndex || proposal.before.contains(cell.across[k]) ||
          proposal.after.contains(cell.across[k])) {
        continue;
      }
      LinkedTriangle& outer = mesh.triangles[cell.across[k]];
      const std::size_t p = outer.slot_of(cell.corner[(k + 1) % 3]),
                        q = outer.slot_of(cell.corner[(k + 2) % 3]);
      outer.across[3 - p - q] = proposal.after[i];
    }
  }
  for (const auto& change : proposal.valence_changes) {
    mesh.valence[change.vertex] = static_cast<std::uint8_t>(mesh.valence[change.vertex] + change.by);
  }
  if (proposal.kind != MoveKind::kRelocation) {
    for (const Index v : proposal.rim) ++mesh.version[v];
  }
  if (proposal.removed != kNoIndex) mesh.incident[proposal.removed] = kNoIndex;
  if (!mesh.contour.empty()) {
    if (proposal.removed != kNoIndex) mesh.contour[proposal.removed] = kOffContour;
    for (const LinkedTriangle& cell : proposal.cells) {
      for (const Index v : cell.corner) {
        if (mesh.is_on_contour(v)) rewind(mesh, v);
      }
    }
  }
  if (proposal.moved != kNoIndex) {
    const double step = distance(mesh.points[proposal.moved], proposal.place);
    if (proposal.kind != MoveKind::kRelocation || step > mesh.least_step) ++mesh.version[proposal.moved];
    mesh.points[proposal.moved] = proposal.place;
    mesh.nearest[proposal.moved] = proposal.place_nearest;
  }
}

}  // namespace periost
