#pragma once
// Removes a bad tetrahedron by a new point: the tetrahedra around it are taken out and the cavity is filled
// with tetrahedra from its faces to the new point.
#include <vector>

#include "stages/improve/tet_complex.h"

namespace periost {

class TetCavity {
 public:
  explicit TetCavity(TetComplex& complex) : complex_(complex) {}

  // Tries places inside the tetrahedron: its centroid, the middles of its edges, then the centroids of its
  // faces. From each a cavity grows through the face whose new tetrahedron would be worst, as long as that is
  // not on a wall, up to 60 tetrahedra, and is cut back to where it was best; then the point climbs
  // (sine_quality.h) and the cavity is grown anew, up to three times. The first that is better than what it
  // replaces by 2 % is made; the new slots are in complex.placed, its point is last in complex.position.
  // `room`: by how many tetrahedra the mesh may grow; `price`: by how much the smallest sine must rise for
  // each tetrahedron more.
  bool insert(Index tet, double target, std::size_t room, double price);

 private:
  // A face of the cavity: the tetrahedron inside and what lies beyond.
  struct Face {
    Index inside = kNoIndex;
    int side = 0;
    Index beyond = kNoIndex;
    TetFan fan;
    double sine = 0;  // of the new tetrahedron
  };
  struct Cavity {
    std::vector<Index> tets;
    std::vector<Face> faces;
    double sine = -2;   // smallest of the new ones
    double before = 2;  // smallest of the old ones
  };

  bool try_place(Vec3 place, const std::vector<Index>& seed, double bad, double target, std::size_t room);
  void grow(const std::vector<Index>& seed, Vec3 place, double target, Cavity& best);
  void take(Index tet, Vec3 place, Cavity& cavity) const;
  void measure(Cavity& cavity) const;
  bool commit(const Cavity& cavity, Vec3 place);

  TetComplex& complex_;
  double price_ = 0;
  Cavity growing_, best_, other_;
  std::vector<Index> seed_, points_;
  std::vector<TetFan> fans_;
  std::vector<Tetrahedron> fresh_;
};

}  // namespace periost
