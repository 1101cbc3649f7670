#include "stages/improve/slide_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "pipeline/geometry/isosurface_query.h"

namespace periost {
namespace {

constexpr int kDeepestPatch = 7;
constexpr std::size_t kNoTriangle = std::numeric_limits<std::size_t>::max();

Vec3 centre(const SlidePatch& p) {
  return (p[0] + p[1] + p[2]) / 3;
}

double radius_about(Vec3 middle, const SlidePatch& p) {
  return std::sqrt(
      std::max({squared_norm(p[0] - middle), squared_norm(p[1] - middle), squared_norm(p[2] - middle)}));
}

double squared_distance(Vec3 p, const SlidePatch& facet) {
  return squared_norm(p - closest_point_on_triangle(p, facet[0], facet[1], facet[2]));
}

// All of the patch lies within `limit` of one triangle: its corners do, since that distance is convex.
bool covers(const SlidePatch& facet, const SlidePatch& patch, double limit) {
  return squared_distance(patch[0], facet) <= limit * limit &&
         squared_distance(patch[1], facet) <= limit * limit &&
         squared_distance(patch[2], facet) <= limit * limit;
}

template <class Body>
bool all_quarters(const SlidePatch& p, Body body) {
  const Vec3 ab = 0.5 * (p[0] + p[1]), bc = 0.5 * (p[1] + p[2]), ca = 0.5 * (p[2] + p[0]);
  return body(SlidePatch{ab, bc, ca}) && body(SlidePatch{p[0], ab, ca}) && body(SlidePatch{ab, p[1], bc}) &&
         body(SlidePatch{ca, bc, p[2]});
}

// All of the patch lies within `limit` of the reference; false where that is not decided at the depth
// allowed. `facet`: a triangle of the reference that may be near, or null. `offence` becomes where it is too
// far.
bool is_within(const SlidePatch& patch, const SlideReference& reference, double limit,
               const SlidePatch* facet, int depth, Vec3& offence) {
  const Vec3 middle = centre(patch);
  double known = limit;
  if (facet != nullptr) {
    if (covers(*facet, patch, limit)) return true;
    // A triangle known to be near makes the search for the nearest one short.
    known = std::min(known, std::sqrt(squared_distance(middle, *facet)) * (1 + 1e-12));
  }
  const std::optional<SlideReference::Hit> hit = reference.closest(middle, known);
  if (!hit || depth == kDeepestPatch) {
    offence = middle;
    return false;
  }
  if (hit->distance + radius_about(middle, patch) <= limit || covers(hit->facet, patch, limit)) return true;
  return all_quarters(patch, [&](const SlidePatch& part) {
    return is_within(part, reference, limit, &hit->facet, depth + 1, offence);
  });
}

// Weights of the corners at a point in the patch's plane.
Vec3 barycentric(const SlidePatch& patch, Vec3 q) {
  const Vec3 u = patch[1] - patch[0], v = patch[2] - patch[0], normal = cross(u, v);
  const double whole = squared_norm(normal);
  const double b = dot(cross(q - patch[0], v), normal) / whole,
               c = dot(cross(u, q - patch[0]), normal) / whole;
  return {1 - b - c, b, c};
}

SurfaceMesh surface_of(const std::vector<SlidePatch>& patches) {
  SurfaceMesh surface;
  for (const SlidePatch& patch : patches) {
    const auto first = static_cast<Index>(surface.points.size());
    surface.points.insert(surface.points.end(), patch.begin(), patch.end());
    surface.triangles.push_back({first, first + 1, first + 2});
  }
  return surface;
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

void SlideDistance::begin(Vec3 point, std::vector<SlidePatch> star) {
  point_ = point;
  star_ = std::move(star);
  offence_.reset();
  is_gathered_ = false;
  rest_.reset();
}

bool SlideDistance::is_near(const std::vector<SlidePatch>& moved, Vec3 point) {
  // Single points first, as most places that are too far are found out so: the point itself, the place that
  // was too far last time, and a few of every triangle.
  if (!reference_.closest(point, limit_)) return false;
  if (offence_) {
    const SlidePatch& patch = moved[offender_];
    const Vec3 again = offence_->x * patch[0] + offence_->y * patch[1] + offence_->z * patch[2];
    if (!reference_.closest(again, limit_)) return false;
  }
  for (const SlidePatch& patch : moved) {
    if (!all_quarters(patch, [&](const SlidePatch& part) {
          return reference_.closest(centre(part), limit_).has_value();
        })) {
      return false;
    }
  }
  for (std::size_t t = 0; t < moved.size(); ++t) {
    Vec3 place;
    if (is_within(moved[t], reference_, limit_, nullptr, 0, place)) continue;
    offender_ = t;
    offence_ = barycentric(moved[t], place);
    return false;
  }
  return true;
}

void SlideDistance::gather() {
  is_gathered_ = true;
  facets_.clear();
  ImproveBox box;
  double radius = 0;
  for (const SlidePatch& patch : star_) {
    for (const Vec3 corner : patch) {
      box.take(corner);
      radius = std::max(radius, distance(corner, point_));
    }
  }
  box.widen(limit_);
  reference_.near(box, near_);
  const SurfaceMesh& surface = reference_.surface();
  for (const Index t : near_) {
    const auto& [a, b, c] = surface.triangles[t];
    const SlidePatch patch{surface.points[a], surface.points[b], surface.points[c]};
    const Vec3 middle = centre(patch);
    const double reach = limit_ + radius_about(middle, patch), far = radius + reach;
    if (squared_norm(middle - point_) > far * far) continue;
    std::size_t nearest = kNoTriangle;
    double least = reach * reach;
    for (std::size_t i = 0; i < star_.size(); ++i) {
      const double squared = squared_distance(middle, star_[i]);
      if (squared > least) continue;
      least = squared;
      nearest = i;
    }
    if (nearest != kNoTriangle) facets_.push_back({patch, nearest, kNoIndex});
  }
}

bool SlideDistance::is_covered(const std::vector<SlidePatch>& moved, const std::vector<SlidePatch>& rest) {
  if (!is_gathered_) gather();
  if (!rest_) rest_.emplace(surface_of(rest), Context{});
  for (std::size_t i = 0; i < facets_.size(); ++i) {
    if (is_covered(facets_[i], moved)) continue;
    std::swap(facets_[0], facets_[i]);  // likely to fail the next time, too
    return false;
  }
  return true;
}

bool SlideDistance::is_covered(Facet& facet, const std::vector<SlidePatch>& moved) const {
  if (covers(moved[facet.near_star], facet.patch, limit_)) return true;
  if (!rest_->is_empty()) {
    if (facet.near_rest == kNoIndex) facet.near_rest = rest_->closest(centre(facet.patch)).slot;
    if (covers(rest_->corners(facet.near_rest), facet.patch, limit_)) return true;
  }
  return is_part_covered(facet.patch, moved, 0);
}

bool SlideDistance::is_part_covered(const SlidePatch& part, const std::vector<SlidePatch>& moved,
                                    int depth) const {
  const Vec3 middle = centre(part);
  const SlidePatch* nearest = nullptr;
  double least = std::numeric_limits<double>::infinity();
  for (const SlidePatch& triangle : moved) {
    const double squared = squared_distance(middle, triangle);
    if (squared >= least) continue;
    least = squared;
    nearest = &triangle;
  }
  if (!rest_->is_empty()) {
    const SpatialSearch::Hit hit = rest_->closest(middle);
    if (hit.squared_distance < least) {
      least = hit.squared_distance;
      nearest = &rest_->corners(hit.slot);
    }
  }
  const double radius = radius_about(middle, part);
  if (std::sqrt(least) + radius <= limit_ || covers(*nearest, part, limit_)) return true;
  const double reach = limit_ + radius;
  const bool was_near = std::any_of(star_.begin(), star_.end(), [&](const SlidePatch& triangle) {
    return squared_distance(middle, triangle) <= reach * reach;
  });
  if (!was_near) return true;
  if (depth == kDeepestPatch) return false;
  return all_quarters(part,
                      [&](const SlidePatch& quarter) { return is_part_covered(quarter, moved, depth + 1); });
}

}  // namespace periost
