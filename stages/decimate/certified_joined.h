#pragma once
// The decimated pieces of an isosurface, joined into one mesh: what is kept between the phases of
// certified_pieces.h.
#include <cstdint>
#include <vector>

#include "stages/decimate/certified_moves.h"

namespace periost {

// One piece, decimated and compact; by its own numbers.
struct DecimatedPiece {
  std::vector<Vec3> points;
  std::vector<Index> nearest;           // of points: triangle of the whole isosurface
  std::vector<Quadric> quadrics;        // of points, about the whole isosurface's first point
  std::vector<std::uint8_t> is_on_cut;  // of points
  std::vector<std::uint8_t> blocked_by;
  std::vector<Triangle> triangles;
  MoveCounts counts;
  Vec3 lo{-1e300, -1e300, -1e300}, hi{1e300, 1e300, 1e300};  // borders that inner vertices keep from
};

// The whole. Dead triangles have kNoIndex as their first corner.
struct JoinedMesh {
  std::vector<Vec3> points;
  std::vector<Index> nearest;
  std::vector<Quadric> quadrics;
  std::vector<std::uint8_t> blocked_by;
  std::vector<Triangle> triangles;
  std::vector<ReverseProof> proofs;  // of isosurface triangles; empty without a reverse distance
  MoveCounts counts;
  Vec3 lo{-1e300, -1e300, -1e300}, hi{1e300, 1e300, 1e300};
};

// The result in `state`, whose reference has the whole isosurface's triangles `whole`; its proofs, with the
// piece's numbers, go into `proofs`, at the whole's. `origin`: the whole isosurface's first point. Borders
// and counts are the caller's.
DecimatedPiece take_piece(const CertifiedState& state, const std::vector<Index>& whole, Vec3 origin,
                          std::vector<ReverseProof>& proofs);

// Adds pieces one by one; those on a cut are joined by their places, to the bit. `isosurface_triangles`: of
// the piece, by the whole's numbers.
class PieceJoiner {
 public:
  explicit PieceJoiner(JoinedMesh& joined) : joined_(joined) {}
  void add(const DecimatedPiece& piece, const std::vector<Index>& isosurface_triangles);

 private:
  struct CutPoint {
    Vec3 place;
    Index number;
  };
  Index find_on_cut(Vec3 place) const;

  JoinedMesh& joined_;
  std::vector<CutPoint> cut_points_;  // sorted by place
};

// Moves the origin of a quadric by `by`.
Quadric moved_origin(const Quadric& quadric, Vec3 by);

// Of triangles: how many proofs name each, as home or label.
std::vector<std::uint32_t> count_uses(const JoinedMesh& joined);

// The result, with the field "blocked_by" of points.
SurfaceMesh surface_of(const JoinedMesh& joined, double voxel_mm);

}  // namespace periost
