#include "stages/improve/slide_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "pipeline/geometry/isosurface_query.h"

namespace periost {
namespace {

constexpr int kDeepestPatch = 7;
constexpr std::size_t kMostUncovered = 8;
constexpr std::size_t kNoTriangle = std::numeric_limits<std::size_t>::max();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Vec3 centre(const SlidePatch& p) {
  return (p[0] + p[1] + p[2]) / 3;
}

double radius_about(Vec3 middle, const SlidePatch& p) {
  return std::sqrt(
      std::max({squared_norm(p[0] - middle), squared_norm(p[1] - middle), squared_norm(p[2] - middle)}));
}

// All of the patch lies within `limit` of one triangle: its corners do, since that distance is convex.
bool covers(const SlideFacet& facet, const SlidePatch& patch, double limit) {
  return facet.squared_distance(patch[0]) <= limit * limit &&
         facet.squared_distance(patch[1]) <= limit * limit &&
         facet.squared_distance(patch[2]) <= limit * limit;
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
  if (hit.distance + radius_about(centre(patch), patch) <= limit) return true;
  const SlideFacet facet(hit.facet);
  if (covers(facet, patch, limit)) return true;
  for (const SlidePatch& part : quarters(patch)) {
    if (covers(facet, part, limit)) continue;
    // A triangle known to be near makes the search for the nearest one short.
    const Vec3 middle = centre(part);
    const double known = std::sqrt(facet.squared_distance(middle)) * (1 + 1e-9);
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
  for (std::size_t i = 0; i < patches.facet.size(); ++i) {
    if (patches.box[i].squared_distance(p) >= least) continue;
    const double squared = patches.facet[i].squared_distance(p);
    if (!(squared < least)) continue;
    least = squared;
    nearest = i;
  }
  return nearest;
}

// Appends the patches whose boxes are within `reach` of the point along each axis.
void take_near(const BoxedPatches& patches, Vec3 p, double reach, std::vector<const SlideFacet*>& near) {
  const Vec3 low = p - Vec3{reach, reach, reach}, high = p + Vec3{reach, reach, reach};
  for (std::size_t i = 0; i < patches.facet.size(); ++i) {
    if (patches.box[i].meets({low, high})) near.push_back(&patches.facet[i]);
  }
}

}  // namespace

SlideFacet::SlideFacet(const SlidePatch& corners)
    : a(corners[0]),
      ab(corners[1] - corners[0]),
      ac(corners[2] - corners[0]),
      normal(cross(ab, ac)),
      ab_ab(squared_norm(ab)),
      ab_ac(dot(ab, ac)),
      ac_ac(squared_norm(ac)),
      per_normal(1 / squared_norm(normal)) {}

double SlideFacet::squared_distance(Vec3 p) const {
  // As closest_point_on_triangle(), whose six products with the two sides follow from two of them.
  const Vec3 ap = p - a;
  const double d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return squared_norm(ap);
  const double d3 = d1 - ab_ab, d4 = d2 - ab_ac;
  if (d3 >= 0 && d4 <= d3) return squared_norm(ap - ab);
  if (d1 * d4 <= d3 * d2 && d1 >= 0 && d3 <= 0) return squared_norm(ap - ab * (d1 / ab_ab));
  const double d5 = d1 - ab_ac, d6 = d2 - ac_ac;
  if (d6 >= 0 && d5 <= d6) return squared_norm(ap - ac);
  if (d5 * d2 <= d1 * d6 && d2 >= 0 && d6 <= 0) return squared_norm(ap - ac * (d2 / ac_ac));
  const double from_b = d4 - d3, from_c = d5 - d6;
  if (d3 * d6 <= d5 * d4 && from_b >= 0 && from_c >= 0) {
    return squared_norm(ap - ab - (ac - ab) * (from_b / (from_b + from_c)));
  }
  const double height = dot(normal, ap);
  return height * height * per_normal;
}

void BoxedPatches::assign(const std::vector<SlidePatch>& patches) {
  facet.clear();
  box.assign(patches.size(), {});
  for (std::size_t i = 0; i < patches.size(); ++i) {
    facet.emplace_back(patches[i]);
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
  star_box_ = {};
  star_radius_ = 0;
  for (const SlidePatch& patch : star) {
    for (const Vec3 corner : patch) {
      star_box_.take(corner);
      star_radius_ = std::max(star_radius_, distance(corner, point));
    }
  }
  offence_.reset();
  is_gathered_ = false;
  has_rest_ = false;
}

bool SlideDistance::is_near(const std::vector<SlidePatch>& moved, Vec3 point) {
  // Single points first, as most places that are too far are found out so: the point itself, the place
  // that was too far last time, and a few of every triangle.
  if (!reference_.closest(point, limit_)) return false;
  if (offence_) {
    const SlidePatch& patch = moved[offender_];
    const Vec3 again = offence_->x * patch[0] + offence_->y * patch[1] + offence_->z * patch[2];
    if (!reference_.closest(again, limit_)) return false;
  }
  parts_.clear();
  for (std::size_t t = 0; t < moved.size(); ++t) {
    for (const SlidePatch& quarter : quarters(moved[t])) {
      const std::optional<SlideReference::Hit> hit = reference_.closest(centre(quarter), limit_);
      if (!hit) return false;
      parts_.push_back({quarter, t, *hit});
    }
  }
  // Where it is far already, it is likely to be too far.
  std::sort(parts_.begin(), parts_.end(),
            [](const Part& a, const Part& b) { return a.hit.distance > b.hit.distance; });
  for (const Part& part : parts_) {
    Vec3 place;
    if (is_within(part.patch, reference_, limit_, part.hit, 1, place)) continue;
    offender_ = part.triangle;
    offence_ = barycentric(moved[part.triangle], place);
    return false;
  }
  return true;
}

void SlideDistance::gather() {
  is_gathered_ = true;
  triangles_.clear();
  uncovered_ = 0;
  ImproveBox box = star_box_;
  box.widen(limit_);
  reference_.near(box, near_);
  const SurfaceMesh& surface = reference_.surface();
  for (const Index t : near_) {
    const auto& [a, b, c] = surface.triangles[t];
    const SlidePatch patch{surface.points[a], surface.points[b], surface.points[c]};
    const Vec3 middle = centre(patch);
    const double reach = limit_ + radius_about(middle, patch), far = star_radius_ + reach;
    if (squared_norm(middle - point_) > far * far) continue;
    double least = std::nextafter(reach * reach, kInfinity);
    const std::size_t nearest = nearest_patch(star_, middle, least);
    if (nearest != kNoTriangle) triangles_.push_back({patch, nearest});
  }
}

bool SlideDistance::is_covered(const std::vector<SlidePatch>& moved, const std::vector<SlidePatch>& rest) {
  if (!is_gathered_) gather();
  moved_.assign(moved);
  last_cover_ = nullptr;
  if (!has_rest_) rest_.assign(rest);
  has_rest_ = true;
  for (std::size_t i = 0; i < triangles_.size(); ++i) {
    if (is_covered(triangles_[i])) continue;
    // Likely to fail the next time, too.
    if (i < uncovered_) return false;
    if (uncovered_ < kMostUncovered) ++uncovered_;
    std::swap(triangles_[uncovered_ - 1], triangles_[i]);
    return false;
  }
  return true;
}

bool SlideDistance::is_uncovered_again(const std::vector<SlidePatch>& moved) {
  if (!has_rest_ || uncovered_ == 0) return false;
  moved_.assign(moved);
  last_cover_ = nullptr;
  for (std::size_t i = 0; i < uncovered_; ++i) {
    if (!is_covered(triangles_[i])) return true;
  }
  return false;
}

bool SlideDistance::is_covered(const NearTriangle& triangle) {
  if (covers(moved_.facet[triangle.near_star], triangle.patch, limit_)) return true;
  // Triangles of the reference come in the order of its cells: what covers one is likely to cover the next.
  if (last_cover_ != nullptr && covers(*last_cover_, triangle.patch, limit_)) return true;
  const Vec3 middle = centre(triangle.patch);
  const double reach = limit_ + radius_about(middle, triangle.patch);
  candidates_.clear();
  take_near(moved_, middle, reach, candidates_);
  take_near(rest_, middle, reach, candidates_);
  return is_part_covered(triangle.patch, nullptr, 0, candidates_.size(), 0);
}

// candidates_[first .. last) are all that can cover any of the part.
bool SlideDistance::is_part_covered(const SlidePatch& part, const SlideFacet* hint, std::size_t first,
                                    std::size_t last, int depth) {
  if (hint != nullptr && covers(*hint, part, limit_)) return true;
  const Vec3 middle = centre(part);
  const double radius = radius_about(middle, part);
  const double reach = std::nextafter((limit_ + radius) * (limit_ + radius), kInfinity);
  candidates_.resize(last);
  double least = kInfinity;
  const SlideFacet* nearest = nullptr;
  for (std::size_t i = first; i < last; ++i) {
    if (!candidates_[i]->is_near_plane(middle, reach)) continue;
    const double squared = candidates_[i]->squared_distance(middle);
    if (!(squared <= reach)) continue;
    candidates_.push_back(candidates_[i]);
    if (squared >= least) continue;
    least = squared;
    nearest = candidates_[i];
  }
  const std::size_t end = candidates_.size();
  if (std::sqrt(least) + radius <= limit_) return true;
  if (nearest != nullptr && covers(*nearest, part, limit_)) {
    last_cover_ = nearest;
    return true;
  }
  double nearest_old = reach;
  // Whole triangles have been found near to the star.
  if (depth > 0 && nearest_patch(star_, middle, nearest_old) == kNoTriangle) return true;
  if (depth == kDeepestPatch) return false;
  const std::array<SlidePatch, 4> parts = quarters(part);
  return std::all_of(parts.begin(), parts.end(), [&](const SlidePatch& quarter) {
    return is_part_covered(quarter, nearest, last, end, depth + 1);
  });
}

}  // namespace periost
