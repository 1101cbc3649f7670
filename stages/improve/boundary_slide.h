#pragma once
// Moves points of the boundary where tetrahedra at them cannot be improved otherwise, within limits that keep
// the surface what it is.
#include <cstdint>
#include <vector>

#include "stages/improve/slide_distance.h"
#include "stages/improve/tet_complex.h"
#include "stages/improve/triangle_grid.h"

namespace periost {

class BoundarySlide {
 public:
  // `boundary`: the outward triangles of the mesh's boundary. They keep their distance of `tolerance_mm` from
  // the reference; both live on. Normals are compared with those at this moment.
  BoundarySlide(TetComplex& complex, const std::vector<Triangle>& boundary, const SlideReference& reference,
                double tolerance_mm);

  // Moves a boundary point whose star is below `target`: freely along the common direction of growth, else
  // along its part in the surface, with backtracking. True when the star's smallest sine rose by more than
  // kLeastGain; star() then holds the tetrahedra, all of which changed. The limits are those that improve.h
  // states. Points that also lie between regions stay.
  bool slide(Index point, double target);

  const std::vector<Index>& star() const { return star_; }
  std::size_t moved_points() const;

 private:
  bool move_towards(Index point, Vec3 goal, double sine);
  bool keeps_shape(Index point, Vec3 place) const;
  bool keeps_apart(Index point, Vec3 place);
  bool keeps_distance(Index point, Vec3 place);
  void gather(Index point);
  ImproveBox star_box(Index point) const;
  SlidePatch patch(Index triangle) const;
  const Index* begin_of(Index point) const { return incident_.data() + first_[point]; }
  const Index* end_of(Index point) const { return incident_.data() + first_[point + 1]; }

  TetComplex& complex_;
  const std::vector<Triangle>& boundary_;
  const SlideReference& reference_;
  double tolerance_;
  std::vector<Index> first_, incident_;  // per point: its boundary triangles
  std::vector<Vec3> first_normal_;       // per boundary triangle, unit
  std::vector<Vec3> first_place_;        // of points, as they came
  double farthest_ = 0;                  // longest way of any point
  TriangleGrid boundary_grid_;
  std::vector<Index> star_;
  std::vector<TetFan> fans_;
  // Boundary triangles around the point at work, gathered when first needed.
  bool is_gathered_ = false;
  std::vector<Index> near_boundary_;
  std::vector<SlidePatch> rest_;  // those that are not at the point
  SlideDistance distance_;
  // Per point: its star when sliding last failed, as a sum over versions.
  std::vector<std::uint64_t> failed_;
};

}  // namespace periost
