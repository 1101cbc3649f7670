#include "stages/decimate/certified_patch.h"

#include <algorithm>

namespace periost {
namespace {

constexpr std::uint8_t kPatchLock = 0x80;
constexpr std::size_t kMostPoints = 256;  // that may come to life in a patch

void sort_and_unify(std::vector<Index>& list) {
  std::sort(list.begin(), list.end());
  list.erase(std::unique(list.begin(), list.end()), list.end());
}

// All triangles at the vertices, ascending.
std::vector<Index> triangles_at(const CertifiedMesh& mesh, const std::vector<Index>& vertices) {
  std::vector<Index> found;
  Star star;
  for (const Index v : vertices) {
    if (gather_ring(mesh, v, star)) found.insert(found.end(), star.triangle.begin(), star.triangle.end());
  }
  sort_and_unify(found);
  return found;
}

std::vector<Index> corners_of(const CertifiedMesh& mesh, const std::vector<Index>& triangles) {
  std::vector<Index> found;
  for (const Index t : triangles) {
    const auto& corner = mesh.triangles[t].corner;
    found.insert(found.end(), corner.begin(), corner.end());
  }
  sort_and_unify(found);
  return found;
}

// Takes the last `most` entries of a list away.
std::vector<Index> take_last(std::vector<Index>& list, std::size_t most) {
  const auto begin = list.end() - static_cast<std::ptrdiff_t>(std::min(most, list.size()));
  std::vector<Index> taken(begin, list.end());
  list.erase(begin, list.end());
  return taken;
}

// What has been taken from the end of a list.
std::vector<Index> born(const std::vector<Index>& before, const std::vector<Index>& now) {
  return {before.begin() + static_cast<std::ptrdiff_t>(now.size()), before.end()};
}

}  // namespace

Patch::Patch(CertifiedState& state, Worker& worker, const std::vector<Index>& seeds, int rings)
    : state_(state),
      worker_(worker),
      dead_points_(take_last(worker.dead_points, kMostPoints)),
      dead_triangles_(take_last(worker.dead_triangles, 2 * kMostPoints)),
      counts_(worker.counts) {
  // The patch has its own ids, so that no more come to life in it than it can take back.
  dead_points_.swap(worker.dead_points);
  dead_triangles_.swap(worker.dead_triangles);
  own_points_ = worker.dead_points;
  own_triangles_ = worker.dead_triangles;
  gather(seeds, rings);
  keep_proofs();
}

Patch::~Patch() {
  for (const Vertex& v : vertices_) state_.mesh.is_locked[v.id] = v.is_locked;
  dead_points_.insert(dead_points_.end(), worker_.dead_points.begin(), worker_.dead_points.end());
  dead_triangles_.insert(dead_triangles_.end(), worker_.dead_triangles.begin(), worker_.dead_triangles.end());
  dead_points_.swap(worker_.dead_points);
  dead_triangles_.swap(worker_.dead_triangles);
}

void Patch::gather(const std::vector<Index>& seeds, int rings) {
  CertifiedMesh& mesh = state_.mesh;
  std::vector<Index> vertices = seeds, triangles;
  for (int ring = 0; ring < rings; ++ring) {
    triangles = triangles_at(mesh, vertices);
    vertices = corners_of(mesh, triangles);
  }
  for (const Index t : triangles) {
    cells_.push_back({t, mesh.triangles[t], state_.proofs.first[t], state_.proofs.first_labelled[t]});
  }
  Star star;
  for (const Index v : vertices) {
    vertices_.push_back({v, mesh.points[v], mesh.nearest[v], mesh.incident[v], mesh.version[v],
                         mesh.valence[v], mesh.is_locked[v], state_.quadrics[v]});
    const bool is_inside =
        gather_star(mesh, v, star) && std::all_of(star.triangle.begin(), star.triangle.end(), [&](Index t) {
          return std::binary_search(triangles.begin(), triangles.end(), t);
        });
    if (!is_inside) mesh.is_locked[v] |= kPatchLock;
  }
}

void Patch::keep_proofs() {
  for (const Cell& cell : cells_) {
    state_.proofs.for_homed(cell.id, [&](Index s) {
      proofs_.push_back({s, state_.proofs.next[s], state_.proofs.proof[s]});
    });
  }
}

std::vector<Index> Patch::triangles() const {
  std::vector<Index> found;
  for (const Cell& cell : cells_) {
    if (state_.mesh.triangles[cell.id].is_alive()) found.push_back(cell.id);
  }
  for (const Index t : born(own_triangles_, worker_.dead_triangles)) {
    if (state_.mesh.triangles[t].is_alive()) found.push_back(t);
  }
  std::sort(found.begin(), found.end());
  return found;
}

std::vector<Index> Patch::free_vertices() const {
  std::vector<Index> found = corners_of(state_.mesh, triangles());
  found.erase(
      std::remove_if(found.begin(), found.end(), [&](Index v) { return state_.mesh.is_locked[v] != 0; }),
      found.end());
  return found;
}

void Patch::restore() {
  CertifiedMesh& mesh = state_.mesh;
  for (const Index t : born(own_triangles_, worker_.dead_triangles)) {
    mesh.triangles[t].corner[0] = kNoIndex;
    state_.proofs.first[t] = state_.proofs.first_labelled[t] = kNoIndex;
  }
  for (const Index v : born(own_points_, worker_.dead_points)) mesh.incident[v] = kNoIndex;
  worker_.dead_points = own_points_;
  worker_.dead_triangles = own_triangles_;
  for (const Vertex& v : vertices_) {
    mesh.points[v.id] = v.place;
    mesh.nearest[v.id] = v.nearest;
    mesh.incident[v.id] = v.incident;
    mesh.version[v.id] = v.version;
    mesh.valence[v.id] = v.valence;
    state_.quadrics[v.id] = v.quadric;
  }
  for (const Cell& cell : cells_) {
    mesh.triangles[cell.id] = cell.record;
    state_.proofs.first[cell.id] = cell.first;
    state_.proofs.first_labelled[cell.id] = cell.first_labelled;
  }
  for (const Proof& kept : proofs_) {
    state_.proofs.next[kept.id] = kept.next;
    state_.proofs.proof[kept.id] = kept.proof;
  }
  for (const Cell& cell : cells_) state_.sheets.insert(mesh, cell.id);
  worker_.counts = counts_;
}

}  // namespace periost
