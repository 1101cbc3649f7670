#pragma once
// Changes of connectivity that keep all points: an edge or a set of faces is taken out and what lay around it
// is filled otherwise. A change is made only if the smallest sine of the tetrahedra concerned rises by more
// than kLeastGain, so no tetrahedron is ever near to flat or inverted.
#include <array>
#include <vector>

#include "stages/improve/tet_complex.h"

namespace periost {

inline constexpr double kLeastGain = 1e-3;

class TetRemoval {
 public:
  explicit TetRemoval(TetComplex& complex) : complex_(complex) {}

  // Takes out the edge a, b of `tet` if its ring has at most seven tetrahedra: of all triangulations of the
  // ring (n tetrahedra become 2 n - 4), the one with the largest smallest sine, by dynamic programming
  // (Klincsek 1980), pruned at what the ring has now. `room`: by how many tetrahedra the mesh may grow.
  bool remove_edge(Index tet, Index a, Index b, std::size_t room);

  // Takes out the face opposite to corner `side`, with neighbouring faces that lie between the same two
  // points where that is better (Shewchuk 2002), to a depth of five; n faces become n + 2 tetrahedra.
  bool remove_faces(Index tet, int side, std::size_t room);

  // Tries all edges and faces of a tetrahedron. The slots that changed are in complex.placed.
  bool remove_any(Index tet, std::size_t room);

 private:
  static constexpr std::size_t kLongestRing = 7;
  static constexpr int kDeepest = 5;

  double triangle_quality(Index a, Index b, std::size_t i, std::size_t j, std::size_t k, double floor) const;
  void collect(Index a, Index b, std::size_t i, std::size_t j);
  double grow(Index a, Index b, Index u, Index v, Index below, Index above, double floor, int depth);

  TetComplex& complex_;
  std::vector<Index> ring_tets_, ring_;
  std::vector<Index> old_;
  std::vector<Tetrahedron> fresh_;
  std::array<std::array<std::size_t, kLongestRing>, kLongestRing> apex_{};
};

}  // namespace periost
