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

#include "stages/decimate/certificate_ring.h"
#include "stages/decimate/certified_mesh.h"

namespace periost {

// Proofs of all isosurface triangles, and two lists of those homed at each output triangle: those that need
// nothing but the home, and those with labels, which moves beside the home may hurt.
struct ReverseProofs {
  std::vector<ReverseProof> proof;  // of isosurface triangles
  std::vector<Index> next;          // of isosurface triangles: the next one in the same list
  std::vector<Index> first;         // of output triangles: of the list without labels
  std::vector<Index> first_labelled;

  // Calls visit(s) for each isosurface triangle homed at output triangle t.
  template <class Visit>
  void for_homed(Index t, Visit&& visit) const {
    for (Index s = first[t]; s != kNoIndex; s = next[s]) visit(s);
    for (Index s = first_labelled[t]; s != kNoIndex; s = next[s]) visit(s);
  }
};

// Each isosurface triangle is its own home.
ReverseProofs make_reverse_proofs(std::size_t triangle_count);

// The renewed proofs of one proposal, to be stored when it is applied; and the buffers of one thread.
struct ReverseScratch {
  // A triangle in the form that answers "within the tolerance?" quickly.
  struct Target {
    Index id;
    std::array<Vec3, 3> corner;
    std::array<Vec3, 3> edge;              // opposite to each corner
    std::array<double, 3> squared_length;  // of the edges
    Vec3 row1, row2, normal;               // d.row1 and d.row2 are barycentric coordinates 1 and 2
    std::array<double, 3> margin;          // barycentric coordinates at the tolerance outside each edge
  };
  std::vector<Target> targets;       // triangles of the new ring first, then those around it; at most 64
  std::uint64_t made = 0;            // bit i: targets[i] is filled in
  std::vector<Index> renewed;        // isosurface triangles
  std::vector<ReverseProof> proofs;  // of `renewed`
  // Of isosurface vertices, where the stamp is the tick: the targets whose distance is known, and those that
  // are within the tolerance.
  std::vector<std::uint64_t> known, mask;
  std::vector<std::uint32_t> stamp;
  std::uint32_t tick = 0;
};

// `around`: the triangles that share a vertex with the ring but are not in it. `ring`: a complete overlay of
// this proposal, null when there is none. Nothing is changed but the scratch. Sound,
// not complete. `tolerance` in mm.
bool certify_reverse(const Reference& reference, const CertifiedMesh& mesh, const ReverseProofs& proofs,
                     const Proposal& proposal, const std::vector<Index>& around, const RingScratch* ring,
                     double tolerance, ReverseScratch& scratch);

// Stores what the last successful certify_reverse of this proposal proved.
void commit_reverse(const Proposal& proposal, const ReverseScratch& scratch, ReverseProofs& proofs);

}  // namespace periost
