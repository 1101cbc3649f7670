#pragma once
// Removes a bad tetrahedron by a new point: the tetrahedra around it are taken out and the cavity is filled
// with tetrahedra from its faces to the new point.
#include <cstddef>
#include <cstdint>
#include <vector>

#include "stages/improve/tet_complex.h"

namespace periost {

class TetCavity {
 public:
  explicit TetCavity(TetComplex& complex) : complex_(complex) {}

  // Tries places inside the tetrahedron: its centroid, then the middles of its edges. From each a cavity
  // grows through the face whose new tetrahedron would be worst, as long as that is not on a wall, up to 60
  // tetrahedra, and is cut back to where it was best; then the point climbs (sine_quality.h) and the cavity
  // is grown anew, up to three times. The first that is better than what it replaces by 2 % is kept for
  // make(). `room`: by how many tetrahedra the mesh may grow; `price`: by how much the smallest sine must
  // rise for each tetrahedron more. Changes nothing, so several may search side by side.
  bool find(Index tet, double target, std::size_t room, double price);

  // Whether all tetrahedra of the cavity found are as they were then, and how many more there will be.
  bool is_current() const;
  std::ptrdiff_t growth() const {
    return static_cast<std::ptrdiff_t>(best_.faces.size()) - static_cast<std::ptrdiff_t>(best_.tets.size());
  }

  // Puts the new point in; the new slots are in complex.placed, its point is last in complex.position.
  // Precondition: find() was true and is_current() is.
  bool make();

  bool insert(Index tet, double target, std::size_t room, double price) {
    return find(tet, target, room, price) && make();
  }

 private:
  static constexpr std::size_t kNever = static_cast<std::size_t>(-1);
  // A face of the cavity: the tetrahedron inside and what lies beyond. Taking the latter ends it.
  struct Face {
    Index inside = kNoIndex;
    int side = 0;
    Index beyond = kNoIndex;
    double sine = 0;                      // of the new tetrahedron
    std::size_t begin = 0, end = kNever;  // sizes of the cavity between which it bounds it
  };
  struct Cavity {
    std::vector<Index> tets;
    std::vector<Face> faces;
    std::size_t worst = 0;  // the face with the smallest sine
    double sine = -2;       // smallest of the new ones
    double before = 2;      // smallest of the old ones
  };

  bool try_place(Vec3 place, const std::vector<Index>& seed, double bad, double target, std::size_t room);
  void grow(const std::vector<Index>& seed, Vec3 place, double target, Cavity& best);
  void take(Index tet, Vec3 place, Cavity& cavity) const;
  static void measure(Cavity& cavity);
  void cut_back(Cavity& cavity, std::size_t size) const;
  bool is_filled() const;

  TetComplex& complex_;
  double price_ = 0;
  Cavity growing_, best_, other_;
  Vec3 place_;                           // of the new point
  std::vector<std::uint32_t> versions_;  // of the cavity's tetrahedra
  std::vector<Index> seed_, points_;
  std::vector<TetFan> fans_;
  std::vector<Tetrahedron> fresh_;
};

}  // namespace periost
