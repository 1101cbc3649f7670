#include "stages/improve/boundary_slide.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "pipeline/geometry/isosurface_query.h"
#include "pipeline/geometry/predicates.h"
#include "stages/improve/tet_removal.h"

namespace periost {
namespace {

constexpr double kLeastSlideGain = 0.01;  // of the smallest sine: a check is dear
constexpr int kSlideHalvings = 2;
constexpr double kLongestSlide = 2;             // tolerances
constexpr double kLeastCosine = 0.9397;         // normals turn by 20 degrees at most
constexpr double kCosineOfLeastAngle = 0.9063;  // 25 degrees, of surface triangles, unless they were worse
constexpr double kJustWithin = 1 - 1e-6;        // of the tolerance, so that rounding stays inside it
constexpr int kDeepestPatch = 7;

struct Patch {
  Vec3 a, b, c;
};

// No facet yet: far from everything.
constexpr std::array<Vec3, 3> kNowhere{Vec3{1e9, 1e9, 1e9}, Vec3{1e9, 1e9, 1e9}, Vec3{1e9, 1e9, 1e9}};

Vec3 centre(const Patch& patch) {
  return (patch.a + patch.b + patch.c) / 3;
}

// All of the patch lies within `limit` of one triangle: its corners do, since that distance is convex.
bool is_covered(const Patch& patch, const std::array<Vec3, 3>& facet, double limit) {
  const auto is_near = [&](Vec3 corner) {
    return squared_norm(corner - closest_point_on_triangle(corner, facet[0], facet[1], facet[2])) <=
           limit * limit;
  };
  return is_near(patch.a) && is_near(patch.b) && is_near(patch.c);
}

// Cosine of the smallest angle of a triangle.
double largest_cosine(const std::array<Vec3, 3>& corners) {
  double squares[3];
  for (std::size_t k = 0; k < 3; ++k) squares[k] = squared_norm(corners[(k + 2) % 3] - corners[(k + 1) % 3]);
  std::sort(squares, squares + 3);
  return (squares[1] + squares[2] - squares[0]) / (2 * std::sqrt(squares[1] * squares[2]));
}

template <class Body>
bool all_quarters(const Patch& p, Body body) {
  const Vec3 ab = 0.5 * (p.a + p.b), bc = 0.5 * (p.b + p.c), ca = 0.5 * (p.c + p.a);
  return body(Patch{ab, bc, ca}) && body(Patch{p.a, ab, ca}) && body(Patch{ab, p.b, bc}) &&
         body(Patch{ca, bc, p.c});
}

double radius_about(Vec3 middle, const Patch& patch) {
  return std::sqrt(std::max(
      {squared_norm(patch.a - middle), squared_norm(patch.b - middle), squared_norm(patch.c - middle)}));
}

// All of the patch lies within `limit` of the reference; false where that is not decided at the depth
// allowed. `facet`: a triangle of the reference that may be near. `offender` becomes where it is too far.
bool is_within(const Patch& patch, const SlideReference& reference, double limit,
               const std::array<Vec3, 3>& facet, int depth, Vec3& offender) {
  if (is_covered(patch, facet, limit)) return true;
  const Vec3 middle = centre(patch);
  // A triangle known to be near makes the search for the nearest one short.
  const double known = distance(middle, closest_point_on_triangle(middle, facet[0], facet[1], facet[2]));
  const std::optional<SlideReference::Hit> hit =
      reference.closest(middle, std::min(limit, known * (1 + 1e-12)));
  if (!hit || depth == kDeepestPatch) {
    offender = middle;
    return false;
  }
  if (hit->distance + radius_about(middle, patch) <= limit) return true;
  if (is_covered(patch, hit->facet, limit)) return true;
  return all_quarters(patch, [&](const Patch& part) {
    return is_within(part, reference, limit, hit->facet, depth + 1, offender);
  });
}

// All of the patch that lies within `limit` of `before` lies within it of `after`. `facet`: a triangle of
// `after` that may be near.
bool stays_within(const Patch& patch, const SpatialSearch& before, const SpatialSearch& after, double limit,
                  const std::array<Vec3, 3>& facet, int depth) {
  if (is_covered(patch, facet, limit)) return true;
  const Vec3 middle = centre(patch);
  const SpatialSearch::Hit hit = after.closest(middle);
  const std::array<Vec3, 3>& nearest = after.corners(hit.slot);
  const double radius = radius_about(middle, patch);
  if (std::sqrt(hit.squared_distance) + radius <= limit || is_covered(patch, nearest, limit)) return true;
  if (std::sqrt(before.closest(middle).squared_distance) > limit + radius) return true;
  if (depth == kDeepestPatch) return false;
  return all_quarters(
      patch, [&](const Patch& part) { return stays_within(part, before, after, limit, nearest, depth + 1); });
}

// Weights of the corners at a point in the patch's plane.
std::array<double, 3> barycentric(const Patch& patch, Vec3 q) {
  const Vec3 normal = cross(patch.b - patch.a, patch.c - patch.a);
  const double whole = squared_norm(normal);
  const double b = dot(cross(q - patch.a, patch.c - patch.a), normal) / whole;
  const double c = dot(cross(patch.b - patch.a, q - patch.a), normal) / whole;
  return {1 - b - c, b, c};
}

bool do_boxes_meet(const ImproveBox& a, const ImproveBox& b) {
  return a.low.x <= b.high.x && b.low.x <= a.high.x && a.low.y <= b.high.y && b.low.y <= a.high.y &&
         a.low.z <= b.high.z && b.low.z <= a.high.z;
}

ImproveBox box_around(const std::vector<Vec3>& points, const Triangle& triangle) {
  ImproveBox box;
  for (const Index corner : triangle) box.take(points[corner]);
  return box;
}

}  // namespace

SlideReference::SlideReference(const Isosurface& isosurface)
    : isosurface_(&isosurface), surface_(isosurface.surface) {}

SlideReference::SlideReference(const SurfaceMesh& surface, const Context& context)
    : surface_(surface),
      search_(std::in_place, surface, context),
      grid_(std::in_place, surface.points, surface.triangles) {}

std::optional<SlideReference::Hit> SlideReference::closest(Vec3 p, double within) const {
  if (search_) {
    const SpatialSearch::Hit hit = search_->closest(p);
    if (hit.squared_distance > within * within) return std::nullopt;
    return Hit{std::sqrt(hit.squared_distance), hit.point, search_->corners(hit.slot)};
  }
  const std::optional<IsosurfacePoint> hit = closest_point(*isosurface_, p, within);
  if (!hit) return std::nullopt;
  const auto& [a, b, c] = surface_.triangles[hit->triangle];
  return Hit{hit->distance, hit->point, {surface_.points[a], surface_.points[b], surface_.points[c]}};
}

void SlideReference::near(const ImproveBox& box, std::vector<Index>& triangles) const {
  if (grid_) return grid_->find(box, triangles);
  triangles.clear();
  ImproveBox cells;  // in the grid's indices; the box may be oblique to it
  for (int corner = 0; corner < 8; ++corner) {
    cells.take(
        isosurface_->frame.to_index({corner & 1 ? box.low.x : box.high.x, corner & 2 ? box.low.y : box.high.y,
                                     corner & 4 ? box.low.z : box.high.z}));
  }
  std::int32_t low[3], high[3];
  for (std::size_t a = 0; a < 3; ++a) {
    const std::int32_t dims = isosurface_->frame.dims[a];
    low[a] = static_cast<std::int32_t>(std::clamp(std::floor(cells.low[a]), -1.0, 1.0 * dims));
    high[a] = static_cast<std::int32_t>(std::clamp(std::floor(cells.high[a]), -2.0, dims - 1.0));
  }
  for (std::int32_t k = low[2]; k <= high[2]; ++k) {
    for (std::int32_t j = low[1]; j <= high[1]; ++j) {
      for (std::int32_t i = low[0]; i <= high[0]; ++i) {
        const TriangleRange range = isosurface_->triangles_of_cell(i, j, k);
        for (Index t = range.begin; t < range.end; ++t) triangles.push_back(t);
      }
    }
  }
}

BoundarySlide::BoundarySlide(TetComplex& complex, const std::vector<Triangle>& boundary,
                             const SlideReference& reference, double tolerance_mm)
    : complex_(complex),
      boundary_(boundary),
      reference_(reference),
      tolerance_(tolerance_mm * kJustWithin),
      first_place_(complex.position),
      boundary_grid_(complex.position, boundary),
      failed_(complex.position.size(), 0) {
  const auto& p = complex.position;
  first_.assign(p.size() + 1, 0);
  for (const Triangle& triangle : boundary) {
    for (const Index corner : triangle) ++first_[corner + 1];
    first_normal_.push_back(
        normalized(cross(p[triangle[1]] - p[triangle[0]], p[triangle[2]] - p[triangle[0]])));
  }
  for (std::size_t i = 0; i + 1 < first_.size(); ++i) first_[i + 1] += first_[i];
  incident_.resize(first_.back());
  std::vector<Index> next(first_.begin(), first_.end() - 1);
  for (Index t = 0; t < boundary.size(); ++t) {
    for (const Index corner : boundary[t]) incident_[next[corner]++] = t;
  }
}

std::size_t BoundarySlide::moved_points() const {
  std::size_t count = 0;
  for (std::size_t i = 0; i < first_place_.size(); ++i) {
    count += complex_.is_on_wall[i] != 0 && complex_.position[i] != first_place_[i] ? 1 : 0;
  }
  return count;
}

// Normals and angles of the triangles at the point.
bool BoundarySlide::keeps_shape(Index point, Vec3 place) const {
  for (const Index* t = begin_of(point); t != end_of(point); ++t) {
    std::array<Vec3, 3> now, then;
    for (std::size_t k = 0; k < 3; ++k) {
      now[k] = complex_.position[boundary_[*t][k]];
      then[k] = boundary_[*t][k] == point ? place : now[k];
    }
    const Vec3 normal = normalized(cross(then[1] - then[0], then[2] - then[0]));
    if (dot(normal, first_normal_[*t]) < kLeastCosine) return false;
    const double cosine = largest_cosine(then);
    if (cosine > kCosineOfLeastAngle && cosine > largest_cosine(now)) return false;
  }
  return true;
}

ImproveBox BoundarySlide::star_box(Index point) const {
  ImproveBox box;
  for (const Index* t = begin_of(point); t != end_of(point); ++t) {
    for (const Index corner : boundary_[*t]) box.take(complex_.position[corner]);
  }
  return box;
}

SurfaceMesh BoundarySlide::local_surface(const std::vector<Index>& triangles) const {
  SurfaceMesh local;
  for (const Index t : triangles) {
    const auto first = static_cast<Index>(local.points.size());
    for (const Index corner : boundary_[t]) local.points.push_back(complex_.position[corner]);
    local.triangles.push_back({first, first + 1, first + 2});
  }
  return local;
}

// The boundary near the point, widened by the way that points have gone since the grid was made.
void BoundarySlide::gather(Index point) {
  if (is_gathered_) return;
  is_gathered_ = true;
  is_reference_gathered_ = false;
  ImproveBox box = star_box(point);
  box.widen(2 * tolerance_);
  ImproveBox wider = box;
  wider.widen(farthest_);
  boundary_grid_.find(wider, near_boundary_);
  std::erase_if(near_boundary_,
                [&](Index t) { return !do_boxes_meet(box_around(complex_.position, boundary_[t]), box); });
}

// A triangle of the reference does not depend on the point where the rest of the boundary is near enough, or
// where those at the point are not.
void BoundarySlide::gather_reference(Index point) {
  is_reference_gathered_ = true;
  std::vector<Index> at_point(begin_of(point), end_of(point)), others;
  std::set_difference(near_boundary_.begin(), near_boundary_.end(), at_point.begin(), at_point.end(),
                      std::back_inserter(others));
  before_.emplace(local_surface(at_point), Context{});
  const SpatialSearch rest(local_surface(others), Context{});
  ImproveBox box = star_box(point);
  box.widen(tolerance_);
  reference_.near(box, near_reference_);
  depending_.clear();
  nearest_.clear();
  double radius = 0;
  for (const Index t : at_point) {
    for (const Index corner : boundary_[t]) {
      radius = std::max(radius, distance(complex_.position[corner], complex_.position[point]));
    }
  }
  const SurfaceMesh& surface = reference_.surface();
  SpatialSearch::Hit hit, other;
  for (const Index t : near_reference_) {
    const auto& [a, b, c] = surface.triangles[t];
    const Patch patch{surface.points[a], surface.points[b], surface.points[c]};
    const Vec3 middle = centre(patch);
    const double reach = tolerance_ + radius_about(middle, patch), far = radius + reach;
    if (squared_norm(middle - complex_.position[point]) > far * far) continue;
    // The triangle that was near to the one before is often near to this one, too.
    if (other.slot != kNoIndex && is_covered(patch, rest.corners(other.slot), tolerance_)) continue;
    hit = before_->closest(middle, hit.slot);
    if (hit.squared_distance > reach * reach) continue;
    if (!rest.is_empty()) other = rest.closest(middle, other.slot);
    if (!rest.is_empty() && is_covered(patch, rest.corners(other.slot), tolerance_)) continue;
    depending_.push_back(t);
    nearest_.push_back(hit.triangle);
  }
}

// No triangle at the point meets another one.
bool BoundarySlide::keeps_apart(Index point, Vec3 place) {
  gather(point);
  const Vec3 kept = std::exchange(complex_.position[point], place);
  bool is_apart = true;
  for (const Index* t = begin_of(point); is_apart && t != end_of(point); ++t) {
    const ImproveBox box = box_around(complex_.position, boundary_[*t]);
    is_apart = std::none_of(near_boundary_.begin(), near_boundary_.end(), [&](Index other) {
      return other != *t && do_boxes_meet(box, box_around(complex_.position, boundary_[other])) &&
             triangles_intersect(complex_.position, boundary_[*t], boundary_[other]);
    });
  }
  complex_.position[point] = kept;
  return is_apart;
}

bool BoundarySlide::keeps_distance(Index point, Vec3 place) {
  gather(point);
  const std::vector<Index> at_point(begin_of(point), end_of(point));
  const Vec3 kept = std::exchange(complex_.position[point], place);
  const SurfaceMesh moved = local_surface(at_point), around = local_surface(near_boundary_);
  complex_.position[point] = kept;
  const auto patch_of = [](const SurfaceMesh& surface, const Triangle& t) {
    return Patch{surface.points[t[0]], surface.points[t[1]], surface.points[t[2]]};
  };
  // Single points first, as most places that are too far are found out so: the point itself, and the place
  // that was too far last time.
  if (!reference_.closest(place, tolerance_)) return false;
  if (offender_triangle_ < moved.triangles.size()) {
    const Patch patch = patch_of(moved, moved.triangles[offender_triangle_]);
    const Vec3 q = offender_[0] * patch.a + offender_[1] * patch.b + offender_[2] * patch.c;
    if (!reference_.closest(q, tolerance_)) return false;
  }
  for (const Triangle& triangle : moved.triangles) {
    if (!all_quarters(patch_of(moved, triangle), [&](const Patch& part) {
          return reference_.closest(centre(part), tolerance_).has_value();
        })) {
      return false;
    }
  }
  for (std::size_t t = 0; t < moved.triangles.size(); ++t) {
    const Patch patch = patch_of(moved, moved.triangles[t]);
    Vec3 offender;
    if (is_within(patch, reference_, tolerance_, kNowhere, 0, offender)) continue;
    offender_triangle_ = t;
    offender_ = barycentric(patch, offender);
    return false;
  }
  if (!is_reference_gathered_) gather_reference(point);
  const SpatialSearch after(around, Context{});
  for (std::size_t i = 0; i < depending_.size(); ++i) {
    const Patch now = patch_of(moved, moved.triangles[nearest_[i]]);
    const Patch patch = patch_of(reference_.surface(), reference_.surface().triangles[depending_[i]]);
    if (!stays_within(patch, *before_, after, tolerance_, {now.a, now.b, now.c}, 0)) {
      // Likely to fail the next time, too.
      std::swap(depending_[0], depending_[i]);
      std::swap(nearest_[0], nearest_[i]);
      return false;
    }
  }
  return true;
}

bool BoundarySlide::move_towards(Index point, Vec3 goal, double sine) {
  const Vec3 from = complex_.position[point];
  const double floor = sine + kLeastSlideGain;
  double share = std::min(1.0, kLongestSlide * tolerance_ / std::max(distance(from, goal), 1e-300));
  for (int halving = 0; halving <= kSlideHalvings; ++halving, share *= 0.5) {
    const Vec3 place = from + share * (goal - from);
    // Cheap tests first; that triangles meet is the rarest.
    if (smallest_sine(fans_, place, floor) <= floor || !keeps_shape(point, place) ||
        !keeps_distance(point, place) || !keeps_apart(point, place)) {
      continue;
    }
    complex_.move(point, place, star_);
    farthest_ = std::max(farthest_, distance(place, first_place_[point]));
    return true;
  }
  return false;
}

bool BoundarySlide::slide(Index point, double target) {
  if (begin_of(point) == end_of(point)) return false;
  complex_.star(point, star_);
  double before = 2;
  std::size_t walls = 0;
  fans_.clear();
  for (const Index tet : star_) {
    before = std::min(before, complex_.quality[tet]);
    const int corner = complex_.corner_of(tet, point);
    fans_.push_back(complex_.fan(tet, corner));
    for (int side = 0; side < 4; ++side) {
      walls += side != corner && complex_.neighbours[tet][as_size(side)] == kNoIndex ? 1 : 0;
    }
  }
  // More walls than boundary: faces between regions; fewer: two sheets that touch in the point.
  if (before >= target || walls != static_cast<std::size_t>(end_of(point) - begin_of(point))) return false;
  std::uint64_t state = 1;
  for (const Index tet : star_) state += complex_.version[tet] * std::uint64_t{0x9E3779B97F4A7C15} + tet;
  if (failed_[point] == state) return false;
  is_gathered_ = false;
  offender_triangle_ = kNoOffender;
  const Vec3 from = complex_.position[point];
  double reached = before;
  if (move_towards(point, climb(fans_, from, target, reached), before)) return true;
  Vec3 normal;
  for (const Index* t = begin_of(point); t != end_of(point); ++t) normal += first_normal_[*t];
  reached = before;
  Vec3 along = climb(fans_, from, target, reached, normalized(normal));
  // Back to the distance from the reference that the point had.
  const double within = distance(from, along) + 2 * tolerance_;
  const std::optional<SlideReference::Hit> then = reference_.closest(from, within);
  const std::optional<SlideReference::Hit> now = reference_.closest(along, within);
  if (then && now) along += (now->point - along) - (then->point - from);
  if (move_towards(point, along, before)) return true;
  failed_[point] = state;
  return false;
}

}  // namespace periost
