#pragma once
// A copy of a part of the certified state, so that several moves there can be taken together and taken back.
//
// A patch is the triangles within some edges of a few vertices. While it is open, its border and what lies on
// contours are locked: a move then changes no triangle outside, and no proof but of what is homed inside,
// since no vertex of a ring that changes lies on the border. What is homed in the patch stays homed in what
// takes its place, so the copy of the patch's triangles, vertices and proofs is all that must be put back.
#include <vector>

#include "stages/decimate/certified_moves.h"

namespace periost {

class Patch {
 public:
  // The triangles up to `rings` away from those at `seeds`; opens it. O(triangles of the patch).
  Patch(CertifiedState& state, Worker& worker, const std::vector<Index>& seeds, int rings);
  // Takes the locks away again; whatever the patch has become stays.
  ~Patch();
  Patch(const Patch&) = delete;
  Patch& operator=(const Patch&) = delete;

  // Puts everything back as it was when the patch was opened, the worker's counts too.
  void restore();

  // The triangles that are in the patch now, ascending, and their vertices that no lock holds.
  std::vector<Index> triangles() const;
  std::vector<Index> free_vertices() const;

 private:
  struct Vertex {
    Index id;
    Vec3 place;
    Index nearest, incident;
    std::uint32_t version;
    std::uint8_t valence, is_locked;
    Quadric quadric;
  };
  struct Cell {
    Index id;
    LinkedTriangle record;
    Index first, first_labelled;
  };
  struct Proof {
    Index id, next;
    ReverseProof proof;
  };

  void gather(const std::vector<Index>& seeds, int rings);
  void keep_vertices();
  void keep_proofs();

  CertifiedState& state_;
  Worker& worker_;
  std::vector<Vertex> vertices_;
  std::vector<Cell> cells_;
  std::vector<Proof> proofs_;
  std::vector<Index> own_points_, own_triangles_;    // that may come to life in the patch
  std::vector<Index> dead_points_, dead_triangles_;  // the worker's others, while the patch is open
  MoveCounts counts_;
};

}  // namespace periost
