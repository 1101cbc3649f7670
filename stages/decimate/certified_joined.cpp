#include "stages/decimate/certified_joined.h"

#include <algorithm>

namespace periost {
namespace {

bool is_before(Vec3 a, Vec3 b) {
  for (std::size_t k = 0; k < 3; ++k) {
    if (a[k] != b[k]) return a[k] < b[k];
  }
  return false;
}

Index shifted(Index number, Index by) {
  return number == kNoIndex ? kNoIndex : number + by;
}

}  // namespace

Quadric moved_origin(const Quadric& quadric, Vec3 by) {
  Quadric moved = quadric;
  moved.b = quadric.b + quadric.times(by);
  moved.c = quadric.at(by);
  return moved;
}

DecimatedPiece take_piece(const CertifiedState& state, const std::vector<Index>& whole, Vec3 origin,
                          std::vector<ReverseProof>& proofs) {
  const CertifiedMesh& mesh = state.mesh;
  const Vec3 by = origin - state.reference.points[0];
  DecimatedPiece piece;
  std::vector<Index> number(mesh.points.size(), kNoIndex);
  for (Index v = 0; v < mesh.points.size(); ++v) {
    if (mesh.incident[v] == kNoIndex) continue;
    number[v] = static_cast<Index>(piece.points.size());
    piece.points.push_back(mesh.points[v]);
    piece.nearest.push_back(whole[mesh.nearest[v]]);
    piece.quadrics.push_back(moved_origin(state.quadrics[v], by));
    piece.is_on_cut.push_back(mesh.is_on_contour(v) && mesh.is_locked[v] ? 1 : 0);
    piece.blocked_by.push_back(state.blocked_by[v]);
  }
  std::vector<Index> triangle(mesh.triangles.size(), kNoIndex);
  for (Index t = 0; t < mesh.triangles.size(); ++t) {
    if (!mesh.triangles[t].is_alive()) continue;
    triangle[t] = static_cast<Index>(piece.triangles.size());
    const auto& c = mesh.triangles[t].corner;
    piece.triangles.push_back({number[c[0]], number[c[1]], number[c[2]]});
  }
  for (Index s = 0; s < whole.size() && state.reverse_tolerance > 0; ++s) {
    ReverseProof proof = state.proofs.proof[s];
    proof.home = triangle[proof.home];
    for (Index& label : proof.label) label = label == kNoIndex ? kNoIndex : triangle[label];
    proofs[whole[s]] = proof;
  }
  return piece;
}

Index PieceJoiner::find_on_cut(Vec3 place) const {
  const auto found = std::lower_bound(cut_points_.begin(), cut_points_.end(), place,
                                      [](const CutPoint& a, Vec3 b) { return is_before(a.place, b); });
  return found != cut_points_.end() && found->place == place ? found->number : kNoIndex;
}

void PieceJoiner::add(const DecimatedPiece& piece, const std::vector<Index>& isosurface_triangles) {
  std::vector<Index> number(piece.points.size());
  std::vector<CutPoint> fresh_on_cut;
  for (Index v = 0; v < number.size(); ++v) {
    const Index known = piece.is_on_cut[v] ? find_on_cut(piece.points[v]) : kNoIndex;
    number[v] = known == kNoIndex ? static_cast<Index>(joined_.points.size()) : known;
    if (known != kNoIndex) {
      joined_.quadrics[known] += piece.quadrics[v];
      continue;
    }
    joined_.points.push_back(piece.points[v]);
    joined_.nearest.push_back(piece.nearest[v]);
    joined_.quadrics.push_back(piece.quadrics[v]);
    joined_.blocked_by.push_back(piece.blocked_by[v]);
    if (piece.is_on_cut[v]) fresh_on_cut.push_back({piece.points[v], number[v]});
  }
  cut_points_.insert(cut_points_.end(), fresh_on_cut.begin(), fresh_on_cut.end());
  std::sort(cut_points_.begin(), cut_points_.end(),
            [](const CutPoint& a, const CutPoint& b) { return is_before(a.place, b.place); });

  const auto before = static_cast<Index>(joined_.triangles.size());
  for (const Triangle& t : piece.triangles)
    joined_.triangles.push_back({number[t[0]], number[t[1]], number[t[2]]});
  for (const Index s : isosurface_triangles) {
    if (joined_.proofs.empty()) break;  // reverse: none
    ReverseProof& proof = joined_.proofs[s];
    proof.home = shifted(proof.home, before);
    for (Index& label : proof.label) label = shifted(label, before);
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    joined_.lo[axis] = std::max(joined_.lo[axis], piece.lo[axis]);
    joined_.hi[axis] = std::min(joined_.hi[axis], piece.hi[axis]);
  }
  joined_.counts += piece.counts;
}

std::vector<std::uint32_t> count_uses(const JoinedMesh& joined) {
  std::vector<std::uint32_t> uses(joined.triangles.size(), 0);
  for (const ReverseProof& proof : joined.proofs) {
    ++uses[proof.home];
    for (const Index label : proof.label) {
      if (label != kNoIndex) ++uses[label];
    }
  }
  return uses;
}

SurfaceMesh surface_of(const JoinedMesh& joined, double voxel_mm) {
  SurfaceMesh surface;
  surface.voxel_mm = voxel_mm;
  std::vector<Index> number(joined.points.size(), kNoIndex);
  auto& blocked = surface.point_fields["blocked_by"];
  for (const Triangle& t : joined.triangles) {
    if (t[0] == kNoIndex) continue;
    for (const Index v : t) {
      if (number[v] != kNoIndex) continue;
      number[v] = static_cast<Index>(surface.points.size());
      surface.points.push_back(joined.points[v]);
      blocked.push_back(static_cast<float>(joined.blocked_by[v]));
    }
    surface.triangles.push_back({number[t[0]], number[t[1]], number[t[2]]});
  }
  return surface;
}

}  // namespace periost
