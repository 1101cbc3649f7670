#pragma once
// Moves points of the boundary where tetrahedra at them cannot be improved otherwise, within limits that keep
// the surface what it is.
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "pipeline/data/isosurface.h"
#include "pipeline/geometry/spatial_search.h"
#include "stages/improve/tet_complex.h"
#include "stages/improve/triangle_grid.h"

namespace periost {

// The surface that a sliding boundary keeps its distance from, as it is asked for closest points.
class SlideReference {
 public:
  // What is given must live on. An isosurface is searched through its voxels, which needs no preparation.
  explicit SlideReference(const Isosurface& isosurface);
  SlideReference(const SurfaceMesh& surface, const Context& context);

  struct Hit {
    double distance = 0;
    Vec3 point;
    std::array<Vec3, 3> facet;  // the triangle that holds the closest point
  };
  // The closest point, or nothing where it is farther than `within`.
  std::optional<Hit> closest(Vec3 p, double within) const;
  // All triangles that meet the box, and others near.
  void near(const ImproveBox& box, std::vector<Index>& triangles) const;
  const SurfaceMesh& surface() const { return surface_; }

 private:
  const Isosurface* isosurface_ = nullptr;
  const SurfaceMesh& surface_;
  std::optional<SpatialSearch> search_;
  std::optional<TriangleGrid> grid_;
};

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
  void gather_reference(Index point);
  ImproveBox star_box(Index point) const;
  SurfaceMesh local_surface(const std::vector<Index>& triangles) const;
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
  // Around the point at work, gathered when first needed: boundary triangles nearby, and the triangles of the
  // reference that only the boundary triangles at the point may be near to, with a search over those as they
  // are.
  bool is_gathered_ = false, is_reference_gathered_ = false;
  std::vector<Index> near_boundary_, near_reference_, depending_;
  std::vector<Index> nearest_;  // of `depending_`: which of the point's triangles is nearest
  std::optional<SpatialSearch> before_;
  // The place that was too far from the reference last time: which of the point's triangles, and where in it.
  static constexpr std::size_t kNoOffender = static_cast<std::size_t>(-1);
  std::size_t offender_triangle_ = kNoOffender;
  std::array<double, 3> offender_{};
  // Per point: its star when sliding last failed, as a sum over versions.
  std::vector<std::uint64_t> failed_;
};

}  // namespace periost
