#pragma once
// The reverse certificate: a proof, kept up to date, that every point of the isosurface lies within a
// tolerance of the output (Periost's algorithm notes, section 5 rule 4).
//
// Every isosurface triangle S stores a home, an output triangle, and up to three labels, output triangles
// that share a vertex with the home; S lies within the tolerance of the union of these. Proof of one S: the
// distance to an output triangle is convex, so S lies within the tolerance of one whose distance to S's three
// corners is; otherwise S is bisected, deeper for smaller tolerances, and each piece finds one. A move
// changes the triangles of one ring. A proof can be hurt only if its home or a label is in that ring, and a
// label shares a vertex with the home: so the proofs to renew are those homed in the ring, and those homed at
// a triangle around the ring whose labels are in it.
#include <array>
#include <cstdint>
#include <vector>

#include "stages/decimate/certified_mesh.h"

namespace periost {

struct ReverseProof {
  Index home = kNoIndex;  // kNoIndex: dropped on request, proved by nothing
  std::array<Index, 3> label{kNoIndex, kNoIndex, kNoIndex};
};

// Proofs of all isosurface triangles, and the lists of those homed at each output triangle.
struct ReverseProofs {
  std::vector<ReverseProof> proof;  // of isosurface triangles
  std::vector<Index> next;          // of isosurface triangles: the next one with the same home
  std::vector<Index> first;         // of output triangles: the first isosurface triangle homed there
};

// Each isosurface triangle is its own home.
ReverseProofs make_reverse_proofs(std::size_t triangle_count);

// The renewed proofs of one proposal, to be stored when it is applied; and the buffers of one thread.
struct ReverseScratch {
  // A triangle in the form that answers "within the tolerance?" quickly.
  struct Target {
    Index id;
    Vec3 lo, hi;  // box around all that is within the tolerance
    std::array<Vec3, 3> corner;
    std::array<Vec3, 3> edge;              // opposite to each corner
    std::array<double, 3> squared_length;  // of the edges
    Vec3 row1, row2, normal;               // d.row1 and d.row2 are barycentric coordinates 1 and 2
    std::array<double, 3> margin;          // barycentric coordinates at the tolerance outside each edge
  };
  std::vector<Target> targets;  // triangles of the new ring first, then those around it; at most 64
  std::size_t ring_size = 0;
  std::vector<Index> renewed;        // isosurface triangles
  std::vector<ReverseProof> proofs;  // of `renewed`
  std::vector<std::uint64_t> mask;   // of isosurface vertices: targets within the tolerance
  std::vector<std::uint32_t> stamp;  // of isosurface vertices: even, ring known; odd, all known
  std::uint32_t tick = 0;
};

// `around`: the triangles that share a vertex with the ring but are not in it. Nothing is changed but the
// scratch. Sound, not complete. `tolerance` in mm.
bool certify_reverse(const Reference& reference, const CertifiedMesh& mesh, const ReverseProofs& proofs,
                     const Proposal& proposal, const std::vector<Index>& around, double tolerance,
                     ReverseScratch& scratch);

// Stores what the last successful certify_reverse of this proposal proved.
void commit_reverse(const Proposal& proposal, const ReverseScratch& scratch, ReverseProofs& proofs);

}  // namespace periost
