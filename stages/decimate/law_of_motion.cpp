#include "stages/decimate/law_of_motion.h"

#include <cmath>

#include "pipeline/geometry/isosurface_contour.h"
#include "pipeline/geometry/isosurface_query.h"
#include "pipeline/geometry/simplex_walk.h"
#include "stages/decimate/contour_model.h"

namespace periost {
namespace {

// The unit normal of an isosurface triangle.
Vec3 triangle_normal(const Isosurface& isosurface, Index triangle) {
  const Triangle& corners = isosurface.surface.triangles[triangle];
  const Vec3 a = isosurface.surface.points[corners[0]];
  return normalized(
      cross(isosurface.surface.points[corners[1]] - a, isosurface.surface.points[corners[2]] - a));
}

// Below this cosine between the model's and the isosurface's normals the tangent plane is no stand-in for the
// isosurface: its intersection with the normal line runs away.
constexpr double kLeastCosine = 0.3;

}  // namespace

void gather_neighbourhood(const SimplexMesh& mesh, const std::vector<SimplexVertex>& seeds, int extent,
                          MotionMarks& marks, std::vector<SimplexVertex>& out) {
  out.clear();
  const auto add = [&](SimplexVertex v) {
    if (v == kNoVertex || marks.local[index_of(v)] != kNoIndex) return;
    marks.local[index_of(v)] = static_cast<std::uint32_t>(out.size());
    out.push_back(v);
  };
  for (const SimplexVertex v : seeds) add(v);
  std::size_t begin = 0;
  for (int step = 0; step < extent; ++step) {
    const std::size_t end = out.size();
    for (; begin < end; ++begin) {
      for (const SimplexVertex w : mesh.neighbour[index_of(out[begin])]) add(w);
    }
  }
  for (const SimplexVertex v : out) marks.local[index_of(v)] = kNoIndex;
}

const std::vector<SimplexVertex>& LawOfMotion::select(const SimplexMesh& mesh,
                                                      const std::vector<SimplexVertex>& seeds) {
  gather_neighbourhood(mesh, seeds, options_.rigidity, marks_, moved_);
  std::erase_if(moved_, [&](SimplexVertex v) { return side_of(v) == kFixedContour; });
  return moved_;
}

std::uint8_t LawOfMotion::side_of(SimplexVertex v) const {
  return contours_ == nullptr || contours_->contours.empty() ? kInside
                                                             : contours_->contours.side[index_of(v)];
}

// Lists Q^s of every moved vertex once, since connectivity does not change between the iterations.
void LawOfMotion::build_samples(const SimplexMesh& mesh) {
  gather_neighbourhood(mesh, moved_, options_.rigidity, marks_, sampled_);
  for (std::size_t i = 0; i < sampled_.size(); ++i) {
    marks_.local[index_of(sampled_[i])] = static_cast<std::uint32_t>(i);
  }
  first_.assign(1, 0);
  of_.clear();
  for (std::uint32_t i = 0; i < moved_.size(); ++i) {
    const std::size_t start = of_.size();
    of_.push_back(i);
    std::size_t begin = start;
    for (int step = 0; step < options_.rigidity; ++step) {
      const std::size_t end = of_.size();
      for (; begin < end; ++begin) {
        for (const SimplexVertex w : mesh.neighbour[index_of(sampled_[of_[begin]])]) {
          if (side_of(w) != side_of(moved_[i])) continue;  // a contour's angles are not the surface's
          const std::uint32_t local = marks_.local[index_of(w)];
          bool listed = false;
          for (std::size_t j = start; j < of_.size() && !listed; ++j) listed = of_[j] == local;
          if (!listed) of_.push_back(local);
        }
      }
    }
    first_.push_back(static_cast<std::uint32_t>(of_.size()));
  }
  for (const SimplexVertex v : sampled_) marks_.local[index_of(v)] = kNoIndex;
}

SimplexParameters LawOfMotion::parameters_of(const SimplexMesh& mesh, SimplexVertex v) const {
  const std::uint8_t side = side_of(v);
  if (side == kInside) return simplex_parameters(mesh, v);
  if (side != kFixedContour) return contour_parameters(*contours_, mesh, v);
  SimplexParameters none;
  none.is_degenerate = true;
  return none;
}

void LawOfMotion::measure(const SimplexMesh& mesh) {
  parameters_.resize(sampled_.size());
  angle_.resize(sampled_.size());
  for (std::size_t i = 0; i < sampled_.size(); ++i) {
    parameters_[i] = parameters_of(mesh, sampled_[i]);
    angle_[i] = parameters_[i].is_degenerate ? 0 : simplex_angle(parameters_[i]);
  }
}

LawOfMotion::Target LawOfMotion::find_target(Vec3 p, Vec3 normal) const {
  const auto hit = closest_along_line(isosurface_, p, normal, options_.reach_mm);
  if (!hit) return {};
  return {hit->point, triangle_normal(isosurface_, hit->triangle), true};
}

LawOfMotion::Target LawOfMotion::find_contour_target(const SimplexMesh& mesh, std::size_t i) const {
  const Vec3 direction = contour_direction(*contours_, mesh, moved_[i]);
  const auto closest = closest_on_contour(isosurface_, contours_->open, position_of(mesh, moved_[i]),
                                          direction, options_.reach_mm);
  if (!closest) return {};
  return {closest->point, contour_normal(*contours_, side_of(moved_[i]), closest->direction), true};
}

Vec3 LawOfMotion::middle_of_neighbours(const SimplexMesh& mesh, SimplexVertex v) const {
  const auto& around = mesh.neighbour[index_of(v)];
  if (side_of(v) != kInside) {
    const SimplexParameters s = parameters_of(mesh, v);
    return s.foot + (0.5 - s.barycentric[1]) * contour_direction(*contours_, mesh, v);
  }
  return (position_of(mesh, around[0]) + position_of(mesh, around[1]) + position_of(mesh, around[2])) / 3.0;
}

Vec3 LawOfMotion::force_on(const SimplexMesh& mesh, std::size_t i) const {
  const SimplexVertex v = moved_[i];
  const SimplexParameters& s = parameters_[i];
  const Vec3 p = position_of(mesh, v);
  if (s.is_degenerate && side_of(v) != kInside) return {};
  const Vec3 centroid = middle_of_neighbours(mesh, v);
  if (s.is_degenerate) return 0.5 * (centroid - p);
  double mean = 0;
  for (std::uint32_t j = first_[i]; j < first_[i + 1]; ++j) mean += angle_[of_[j]];
  mean /= static_cast<double>(first_[i + 1] - first_[i]);
  double along_normal = 0.5 * (height_at_angle(mean, s.power, s.circumradius) - s.height);
  const Target& target = target_[i];
  const double cosine = dot(s.normal, target.normal);
  if (target.found && cosine > kLeastCosine) {
    along_normal += options_.stiffness * dot(target.point - p, target.normal) / cosine;
  }
  return 0.5 * (centroid - s.foot) + along_normal * s.normal;
}

void LawOfMotion::deform(SimplexMesh& mesh) {
  build_samples(mesh);
  const std::size_t count = moved_.size();
  previous_.resize(count);
  next_.resize(count);
  target_.resize(count);
  for (std::size_t i = 0; i < count; ++i) previous_[i] = position_of(mesh, moved_[i]);
  for (int iteration = 0; iteration < options_.iterations; ++iteration) {
    measure(mesh);
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3 p = position_of(mesh, moved_[i]);
      if (iteration == 0) {
        target_[i] = parameters_[i].is_degenerate    ? Target{}
                     : side_of(moved_[i]) != kInside ? find_contour_target(mesh, i)
                                                     : find_target(p, parameters_[i].normal);
      }
      next_[i] = p + (1 - options_.damping) * (p - previous_[i]) + force_on(mesh, i);
    }
    for (std::size_t i = 0; i < count; ++i) {
      previous_[i] = position_of(mesh, moved_[i]);
      const std::uint8_t side = side_of(moved_[i]);
      mesh.position[index_of(moved_[i])] =
          side == kInside ? next_[i] : on_border_plane(isosurface_.frame, side, next_[i]);
    }
  }
}

}  // namespace periost
