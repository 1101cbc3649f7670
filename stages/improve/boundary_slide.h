#pragma once
// The boundary of a mesh whose points may slide, and what has to be known of it to judge a move. Moves are
// found by slide_trial.h.
#include <cstdint>
#include <span>
#include <vector>

#include "stages/improve/slide_distance.h"
#include "stages/improve/tet_complex.h"
#include "stages/improve/triangle_grid.h"

namespace periost {

// A move of one point, with all tetrahedra at it.
struct SlideMove {
  Index point = kNoIndex;
  Vec3 place;
  std::vector<Index> star;
};

class BoundarySlide {
 public:
  // `boundary`: the outward triangles of the mesh's boundary. They keep their distance of `tolerance_mm` from
  // the reference; all three live on. Normals are compared with those at this moment.
  BoundarySlide(TetComplex& complex, const std::vector<Triangle>& boundary, const SlideReference& reference,
                double tolerance_mm);

  const TetComplex& complex() const { return complex_; }
  const SlideReference& reference() const { return reference_; }
  double tolerance() const { return tolerance_; }  // mm, a little less than what was given
  const Triangle& triangle(Index t) const { return boundary_[t]; }
  Vec3 first_normal(Index triangle) const { return first_normal_[triangle]; }  // unit

  // Triangles at a point, ascending; none at points inside.
  std::span<const Index> triangles_at(Index point) const {
    if (point + 1 >= first_.size()) return {};
    return {incident_.data() + first_[point], incident_.data() + first_[point + 1]};
  }
  // All triangles that meet the box now.
  void near(const ImproveBox& box, std::vector<Index>& triangles) const;
  // A box that holds all that trials for corners of `tet` look at and all that their moves change. Where two
  // such boxes do not meet, neither trial depends on the other's move.
  ImproveBox reach(Index tet) const;

  void make(const SlideMove& move);
  std::size_t moved_points() const;

  // Whether a trial for the point failed in this state of its star, and a note that it did. Different points
  // may be asked from several threads.
  bool has_failed(Index point, std::uint64_t state) const { return failed_[point] == state; }
  void note_failure(Index point, std::uint64_t state) { failed_[point] = state; }

 private:
  TetComplex& complex_;
  const std::vector<Triangle>& boundary_;
  const SlideReference& reference_;
  double tolerance_;
  std::vector<Index> first_, incident_;  // per point: its boundary triangles
  std::vector<Vec3> first_normal_;       // per boundary triangle
  std::vector<Vec3> first_place_;        // of points, as they came
  double farthest_ = 0;                  // longest way of any point
  TriangleGrid boundary_grid_;
  std::vector<std::uint64_t> failed_;  // per point: its star when a trial last failed
};

}  // namespace periost
