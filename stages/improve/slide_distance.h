#pragma once
// Whether a surface stays within its distance of a reference, both ways, while one of its points moves.
// Bounds on whole triangles, not samples.
#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "pipeline/data/isosurface.h"
#include "pipeline/geometry/spatial_search.h"
#include "stages/improve/triangle_grid.h"

namespace periost {

// The surface that a sliding boundary keeps its distance from, as it is asked for closest points.
class SlideReference {
 public:
  // What is given must live on. An isosurface is searched through its voxels, which needs no preparation;
  // precondition: it has any.
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

// The corners of a triangle, or of a part of one.
using SlidePatch = std::array<Vec3, 3>;

// A triangle with what is the same for all points whose distance to it is asked.
struct SlideFacet {
  SlideFacet() = default;
  explicit SlideFacet(const SlidePatch& corners);
  // From a point to the nearest of the triangle; NaN may come of a degenerate one.
  double squared_distance(Vec3 p) const;
  // Whether its plane is no farther than that; if not, the triangle is not, either.
  bool is_near_plane(Vec3 p, double squared) const {
    const double height = dot(normal, p - a);
    return !(height * height * per_normal > squared);
  }

  Vec3 a, ab, ac, normal;
  double ab_ab = 0, ab_ac = 0, ac_ac = 0;
  double per_normal = 0;  // 1 / |normal|^2
};

// Triangles with their boxes, for many searches of the nearest.
struct BoxedPatches {
  std::vector<SlideFacet> facet;
  std::vector<ImproveBox> box;
  void assign(const std::vector<SlidePatch>& patches);
};

class SlideDistance {
 public:
  // The reference must live on.
  SlideDistance(const SlideReference& reference, double limit_mm) : reference_(reference), limit_(limit_mm) {}

  // The triangles at the point, before it moves. What is asked next is about moves of this point.
  void begin(Vec3 point, const std::vector<SlidePatch>& star);

  // All of the moved triangles lies within the limit of the reference. A false may be due to the depth to
  // which parts are looked at.
  bool is_near(const std::vector<SlidePatch>& moved, Vec3 point);

  // All of the reference that lies within the limit of the triangles before the move lies within it of those
  // after the move or of the rest of the surface, of which `rest` must hold what is within twice the limit of
  // the star's box. `rest` must be the same from one begin() to the next. As for a false, see is_near().
  bool is_covered(const std::vector<SlidePatch>& moved, const std::vector<SlidePatch>& rest);

  // Whether what was not covered after other moves of the point is not after this one: a quick no.
  bool is_uncovered_again(const std::vector<SlidePatch>& moved);

 private:
  struct NearTriangle {  // of the reference
    SlidePatch patch;
    std::size_t near_star;  // the triangle of the star that is likely to cover it
  };
  void gather();
  bool is_covered(const NearTriangle& triangle);
  // `hint`: a triangle that is likely to cover the part, or null.
  bool is_part_covered(const SlidePatch& part, const SlideFacet* hint, std::size_t first, std::size_t last,
                       int depth);

  const SlideReference& reference_;
  double limit_;
  Vec3 point_;
  BoxedPatches star_, moved_;
  ImproveBox star_box_;
  double star_radius_ = 0;  // from the point
  // Where a moved triangle was too far last time.
  std::size_t offender_ = 0;
  std::optional<Vec3> offence_;  // weights of its corners
  bool is_gathered_ = false;
  std::vector<Index> near_;
  std::vector<NearTriangle> triangles_;  // those that the star may be near to
  std::size_t uncovered_ = 0;            // the first of them, which some move left uncovered
  bool has_rest_ = false;
  BoxedPatches rest_;
  struct Part {  // a quarter of a moved triangle
    SlidePatch patch;
    std::size_t triangle;
    SlideReference::Hit hit;
  };
  std::vector<Part> parts_;
  std::vector<const SlideFacet*> candidates_;  // a stack of lists
  const SlideFacet* last_cover_ = nullptr;     // what covered a part of the reference last
};

}  // namespace periost
