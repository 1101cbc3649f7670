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
constexpr double kInfinity = std::numeric_limits<double>::infinity();

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

std::array<SlidePatch, 4> quarters(const SlidePatch& p) {
  const Vec3 ab = 0.5 * (p[0] + p[1]), bc = 0.5 * (p[1] + p[2]), ca = 0.5 * (p[2] + p[0]);
  return {SlidePatch{ab, bc, ca}, SlidePatch{p[0], ab, ca}, SlidePatch{ab, p[1], bc},
          SlidePatch{ca, bc, p[2]}};
}

// All of the patch lies within `limit` of the reference; false where that is not decided at the depth
// allowed. `hit`: what is nearest to its centre. `offence` becomes where it is too far.
bool is_within(const SlidePatch& patch, const SlideReference& reference, double limit,
               const SlideReference::Hit& hit, int depth, Vec3& offence) {
  if (hit.distance + radius_about(centre(patch), patch) <= limit || covers(hit.facet, patch, limit)) {
    return true;
  }
  for (const SlidePatch& part : quarters(patch)) {
    if (covers(hit.facet, part, limit)) continue;
    // A triangle known to be near makes the search for the nearest one short.
    const Vec3 middle = centre(part);
    const double known = std::sqrt(squared_distance(middle, hit.facet)) * (1 + 1e-12);
    const std::optional<SlideReference::Hit> nearest = reference.closest(middle, std::min(limit, known));
    if (!nearest || depth + 1 == kDeepestPatch) {
      offence = middle;
      return false;
    }
    if (!is_within(part, reference, limit, *nearest, depth + 1, offence)) return false;
  }
  return true;
}

// Weights of the corners at a point in the patch's plane.
Vec3 barycentric(const SlidePatch& patch, Vec3 q) {
  const Vec3 u = patch[1] - patch[0], v = patch[2] - patch[0], normal = cross(u, v);
  const double whole = squared_norm(normal);
  const double b = dot(cross(q - patch[0], v), normal) / whole,
               c = dot(cross(u, q - patch[0]), normal) / whole;
  return {1 - b - c, b, c};
}

// The nearest of the patches that is nearer than the square root of `least`, which becomes the square of its
// distance; kNoTriangle without any.
std::size_t nearest_patch(const BoxedPatches& patches, Vec3 p, double& least) {
  std::size_t nearest = kNoTriangle;
  for (std::size_t i = 0; i < patches.patch.size(); ++i) {
    if (patches.box[i].squared_distance(p) >= least) continue;
    const double squared = squared_distance(p, patches.patch[i]);
    if (squared >= least) continue;
    least = squared;
    nearest = i;
  }
  return nearest;
}

}  // namespace

void BoxedPatches::assign(const std::vector<SlidePatch>& patches) {
  patch = patches;
  box.assign(patches.size(), {});
  for (std::size_t i = 0; i < patches.size(); ++i) {
    for (const Vec3 corner : patches[i]) box[i].take(corner);
  }
}

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

void SlideDistance::begin(Vec3 point, const std::vector<SlidePatch>& star) {
  point_ = point;
  star_.assign(star);
  offence_.reset();
  is_gathered_ = false;
  has_rest_ = false;
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
  quarter_hits_.resize(moved.size());
  for (std::size_t t = 0; t < moved.size(); ++t) {
    const std::array<SlidePatch, 4> parts = quarters(moved[t]);
    for (std::size_t q = 0; q < parts.size(); ++q) {
      const std::optional<SlideReference::Hit> hit = reference_.closest(centre(parts[q]), limit_);
      if (!hit) return false;
      quarter_hits_[t][q] = *hit;
    }
  }
  for (std::size_t t = 0; t < moved.size(); ++t) {
    const std::array<SlidePatch, 4> parts = quarters(moved[t]);
    for (std::size_t q = 0; q < parts.size(); ++q) {
      Vec3 place;
      if (is_within(parts[q], reference_, limit_, quarter_hits_[t][q], 1, place)) continue;
      offender_ = t;
      offence_ = barycentric(moved[t], place);
      return false;
    }
  }
  return true;
}

void SlideDistance::gather() {
  is_gathered_ = true;
  facets_.clear();
  ImproveBox box;
  double radius = 0;
  for (const SlidePatch& patch : star_.patch) {
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
    double least = std::nextafter(reach * reach, kInfinity);
    const std::size_t nearest = nearest_patch(star_, middle, least);
    if (nearest != kNoTriangle) facets_.push_back({patch, nearest, kNoTriangle});
  }
}

bool SlideDistance::is_covered(const std::vector<SlidePatch>& moved, const std::vector<SlidePatch>& rest) {
  if (!is_gathered_) gather();
  moved_.assign(moved);
  if (!has_rest_) rest_.assign(rest);
  has_rest_ = true;
  for (std::size_t i = 0; i < facets_.size(); ++i) {
    if (is_covered(facets_[i])) continue;
    std::swap(facets_[0], facets_[i]);  // likely to fail the next time, too
    return false;
  }
  return true;
}

bool SlideDistance::is_covered(Facet& facet) const {
  if (covers(moved_.patch[facet.near_star], facet.patch, limit_)) return true;
  if (facet.near_rest == kNoTriangle) {
    double least = kInfinity;
    facet.near_rest = nearest_patch(rest_, centre(facet.patch), least);
  }
  if (facet.near_rest != kNoTriangle && covers(rest_.patch[facet.near_rest], facet.patch, limit_)) {
    return true;
  }
  return is_part_covered(facet.patch, nullptr, 0);
}

bool SlideDistance::is_part_covered(const SlidePatch& part, const SlidePatch* hint, int depth) const {
  if (hint != nullptr && covers(*hint, part, limit_)) return true;
  const Vec3 middle = centre(part);
  double least = kInfinity;
  const std::size_t of_moved = nearest_patch(moved_, middle, least);
  const std::size_t of_rest = nearest_patch(rest_, middle, least);
  const SlidePatch& nearest = of_rest != kNoTriangle ? rest_.patch[of_rest] : moved_.patch[of_moved];
  const double radius = radius_about(middle, part);
  if (std::sqrt(least) + radius <= limit_ || covers(nearest, part, limit_)) return true;
  double reach = std::nextafter((limit_ + radius) * (limit_ + radius), kInfinity);
  if (nearest_patch(star_, middle, reach) == kNoTriangle) return true;
  if (depth == kDeepestPatch) return false;
  const std::array<SlidePatch, 4> parts = quarters(part);
  return std::all_of(parts.begin(), parts.end(), [&](const SlidePatch& quarter) {
    return is_part_covered(quarter, &nearest, depth + 1);
  });
}

}  // namespace periost
