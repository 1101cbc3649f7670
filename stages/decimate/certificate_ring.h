#pragma once
// One overlay for both certificates: all new triangles of a ring and the isosurface under them, seen along
// one direction. It proves in one flood what certificate_forward.h and certificate_reverse.h prove triangle
// by triangle, wherever both sheets are height fields over the same plane, which they mostly are; what it
// leaves open is decided there.
//
// Let d be the ring's mean normal. The new triangles are a fan: they share a corner, the apex, and their
// shadows along d tile a polygon. Starting at the isosurface triangle under a point of the fan, collect
// isosurface triangles across every edge whose shadow meets the fan's. The corners of the overlay of both are
// the isosurface's vertices over the fan, the fan's vertices, and the crossings of their edges; between them
// the height of one over the other is linear. Early on most vertices of a fan are still the isosurface's own:
// there both meet at height 0, nothing crosses, and an isosurface edge that is the fan's border is where the
// patch ends.
//
// Forward. No edge on the collected patch's border has a shadow that meets the inside of the fan's, so the
// degree of the patch over the fan is the same everywhere; if it is at least 1, each point of a new triangle
// has a collected one over or under it. So a new triangle is within the tolerance of the isosurface if the
// heights at all corners of its overlay are.
//
// Reverse. An isosurface triangle whose shadow lies in the fan's, so that none of its own corners of the
// overlay lies on the fan's border or beyond but where that has the same vertex, is covered by the new
// triangles that it overlaps; it is within the tolerance of these if the heights at its own corners are. The
// degree does not matter here: where a thin body folds back under the fan it is 0, and the forward proof
// fails, but not this one.
//
// Decisions are made in floating point. A crossing that is missed lies within rounding of one that is not, so
// the error in distance is of the order of 1e-12 of the sizes concerned, and is part of what callers keep of
// the tolerance.
#include <cstdint>
#include <vector>

#include "stages/decimate/certificate_fan.h"
#include "stages/decimate/certificate_forward.h"
#include "stages/decimate/certified_mesh.h"

namespace periost {

// Which output triangles an isosurface triangle lies within the tolerance of, all taken together.
struct ReverseProof {
  Index home = kNoIndex;
  std::array<Index, 3> label{kNoIndex, kNoIndex, kNoIndex};
};

// Buffers of one thread, and what the last overlay proved.
struct RingScratch {
  // An isosurface vertex in the fan's frame: x and y along the plane, z along d, mm from the apex.
  struct Foot {
    double x, y, z;
    std::uint32_t sides;    // bit l: left of line l
    std::uint32_t cell;     // the new triangle that it is over, as a bit; 0: none
    std::uint32_t inside;   // likewise, but 0 where it is a vertex of the fan
    std::uint32_t vertex;   // the fan's vertex that it is, as a bit; 0: none. `cell` has all there
    std::uint32_t touched;  // bits of the lines that meet at that vertex
    bool is_high;           // further than the tolerance from it
    std::array<double, 2 * kMaxFan> offset;  // from line l, times its length
  };
  struct Visit {
    Index triangle;       // of the isosurface
    std::uint32_t cells;  // new triangles that it overlaps
    bool leaves;          // perhaps not covered by the fan
    bool is_high;         // further than the tolerance from it at a corner of the overlay
    std::array<std::uint32_t, 3> foot;

    void add(const Visit& seen) {
      cells |= seen.cells;
      leaves |= seen.leaves;
      is_high |= seen.is_high;
    }
  };
  std::vector<Foot> feet;
  std::vector<Visit> visits;
  // Where the foot of a vertex, or the visit of a triangle, stands; valid if the stamp is the tick.
  struct Mark {
    std::uint32_t stamp = 0, at = 0;
  };
  std::vector<Mark> foot_of;   // of isosurface vertices
  std::vector<Mark> visit_of;  // of isosurface triangles
  std::uint32_t tick = 0;
  std::uint32_t unproved = 0;  // bit j: the j-th new triangle is too high somewhere
  bool is_complete = false;    // all isosurface triangles under the fan were visited

  // Null when the overlay did not come by.
  const Foot* find_foot(Index vertex) const {
    return foot_of[vertex].stamp == tick ? &feet[foot_of[vertex].at] : nullptr;
  }
  const Visit* find_visit(Index triangle) const {
    return visit_of[triangle].stamp == tick ? &visits[visit_of[triangle].at] : nullptr;
  }
};

// A new triangle with what is stored at its corners.
DualTriangle dual_triangle(const CertifiedMesh& mesh, const Proposal& proposal, const LinkedTriangle& cell);

// kProved: all new triangles are within the tolerance of the isosurface. kRefuted: it could not prove one.
// kUnknown: only those in scratch.unproved are, which are too high somewhere: these are proved not by their
// heights but by certify_forward. `proposal` has its place and place_nearest;
// `tolerance` in mm. Sound, not complete. Time is linear in the isosurface triangles under the ring.
Answer certify_ring(const Reference& reference, const CertifiedMesh& mesh, const Proposal& proposal,
                    double tolerance, ForwardScratch& forward, RingScratch& scratch);

// After kProved: whether the overlay proves that isosurface triangle `s` is within the tolerance of at most
// four new triangles; these are written to `proof`.
bool is_covered_by_ring(const Proposal& proposal, const RingScratch& scratch, Index s, ReverseProof& proof);

}  // namespace periost
