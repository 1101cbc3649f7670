#pragma once
// Finds moves of boundary points that raise the worst tetrahedron at them within limits that keep the surface
// what it is. A trial changes nothing, so trials whose BoundarySlide::reach() do not meet may run side by
// side.
#include <cstdint>
#include <optional>
#include <vector>

#include "stages/improve/boundary_slide.h"

namespace periost {

inline constexpr double kLongestSlide = 2;  // of one move, in tolerances

class SlideTrial {
 public:
  explicit SlideTrial(BoundarySlide& slide)
      : slide_(slide), distance_(slide.reference(), slide.tolerance()) {}

  // A move of a boundary point whose star is below `target`, along the surface, else freely, by the common
  // direction of growth with backtracking, so that the star's smallest sine rises by more than `gain`. The
  // limits are those that improve.h states. Points that also lie between regions stay.
  bool climb_to(Index point, double target, double gain);

  // The same from a fixed pattern of places around the point, best first: slower, and it finds moves where
  // the limits leave no way along the direction of growth.
  bool search(Index point, double target, double gain);

  // What the last call found.
  const SlideMove& move() const { return move_; }

 private:
  bool begin(Index point, double target, double& before);
  bool is_allowed(Vec3 place);
  bool try_towards(Vec3 goal, double floor);
  bool keeps_shape(Vec3 place) const;
  bool keeps_distance(Vec3 place);
  bool keeps_apart(Vec3 place);
  Vec3 along_surface(double target, double before) const;
  void gather();
  SlidePatch patch(Index triangle, Vec3 place) const;

  BoundarySlide& slide_;
  SlideDistance distance_;
  SlideMove move_;
  Vec3 from_;
  std::vector<TetFan> fans_;
  std::vector<SlidePatch> moved_;
  // Boundary triangles around the point, gathered when first needed.
  bool is_gathered_ = false;
  std::vector<Index> near_;
  std::vector<SlidePatch> rest_;  // those that are not at the point
  // The same with corners numbered anew; those at the point come first.
  std::vector<Vec3> local_points_;
  std::vector<Triangle> local_;
};

}  // namespace periost
