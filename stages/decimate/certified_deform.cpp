#include "stages/decimate/certified_deform.h"

#include <algorithm>
#include <utility>

#include "pipeline/base/parallel.h"
#include "pipeline/geometry/simplex_geometry.h"
#include "stages/decimate/certified_contour_deform.h"

namespace periost {
namespace {

constexpr std::size_t kBlock = 2048;
constexpr double kReach = 1.5;        // tolerances within which the isosurface is looked for
constexpr double kLeastStep = 0.1;    // tolerances; smaller ones are not worth a check
constexpr double kLeastFacing = 0.5;  // product of the normals below which it does not

// The living triangles, numbered without gaps.
struct Living {
  std::vector<Index> triangle;  // by number
  std::vector<Index> number;    // of triangles; kNoIndex for dead ones
};
Living living_triangles_of(const CertifiedMesh& mesh) {
  Living living;
  living.number.assign(mesh.triangles.size(), kNoIndex);
  for (Index t = 0; t < mesh.triangles.size(); ++t) {
    if (!mesh.triangles[t].is_alive()) continue;
    living.number[t] = static_cast<Index>(living.triangle.size());
    living.triangle.push_back(t);
  }
  return living;
}

// A simplex vertex: its geometry against its neighbours and its simplex angle. `is_free`: it has three
// neighbours that do not lie on a line.
struct Sample {
  Vec3 place, centroid;  // of itself, of its neighbours
  SimplexParameters parameters;
  double angle = 0;
  bool is_free = false;
};

Sample sample_of(const CertifiedMesh& mesh, Index t) {
  Sample sample;
  const LinkedTriangle& triangle = mesh.triangles[t];
  sample.place = barycentre(mesh, t);
  std::array<Vec3, 3> neighbours;
  for (std::size_t k = 0; k < 3; ++k) {
    if (triangle.across[k] == kNoIndex) return sample;
    neighbours[k] = barycentre(mesh, triangle.across[k]);
  }
  sample.centroid = (neighbours[0] + neighbours[1] + neighbours[2]) / 3;
  sample.parameters = simplex_parameters(sample.place, neighbours);
  sample.is_free = !sample.parameters.is_degenerate;
  if (sample.is_free) sample.angle = simplex_angle(sample.parameters);
  return sample;
}

// The mean simplex angle over Q^s of a triangle, breadth first.
double mean_angle(const CertifiedMesh& mesh, const Living& living, const std::vector<Sample>& samples,
                  Index t, int extent, std::vector<Index>& found) {
  found.assign(1, t);
  std::size_t ring = 0;
  for (int step = 0; step < extent; ++step) {
    const std::size_t end = found.size();
    for (; ring < end; ++ring) {
      for (const Index next : mesh.triangles[found[ring]].across) {
        if (next != kNoIndex && std::find(found.begin(), found.end(), next) == found.end())
          found.push_back(next);
      }
    }
  }
  double sum = 0;
  std::size_t count = 0;
  for (const Index near : found) {
    const Sample& sample = samples[living.number[near]];
    if (!sample.is_free) continue;
    sum += sample.angle;
    ++count;
  }
  return sum / static_cast<double>(count);
}

// How far the plane of the near isosurface triangle lies along the normal; 0 when there is none that faces
// the same way.
double height_of_isosurface(const CertifiedState& state, const Sample& sample, Index near) {
  if (near == kNoIndex) return 0;
  const Vec3 n = sample.parameters.normal, facing = state.reference.normals[near];
  if (dot(n, facing) < kLeastFacing) return 0;
  return dot(state.reference.corners(near)[0] - sample.place, facing) / dot(n, facing);
}

Vec3 force_on(const CertifiedState& state, const DecimateOptions& options, const Living& living,
              const std::vector<Sample>& samples, Index t, Index near, std::vector<Index>& found) {
  const Sample& sample = samples[living.number[t]];
  const SimplexParameters& p = sample.parameters;
  const double angle = mean_angle(state.mesh, living, samples, t, options.rigidity, found);
  const double rise = height_at_angle(angle, p.power, p.circumradius) - p.height;
  const double pull = options.stiffness * height_of_isosurface(state, sample, near);
  return (sample.centroid - p.foot) * 0.5 + p.normal * (0.5 * rise + pull);
}

// One step from where the vertices are.
std::vector<Vec3> next_places(const CertifiedState& state, const DecimateOptions& options, Motion& motion,
                              const Context& context) {
  const CertifiedMesh& mesh = state.mesh;
  const Living living = living_triangles_of(mesh);
  const std::size_t count = living.triangle.size();
  std::vector<Sample> samples(count);
  std::vector<Vec3> forces(count);
  parallel_blocks(context, count, kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) samples[i] = sample_of(mesh, living.triangle[i]);
  });
  const bool is_first = motion.near.empty();
  motion.near.resize(count, kNoIndex);
  parallel_blocks(context, count, kBlock, [&](std::size_t begin, std::size_t end) {
    std::vector<Index> found;
    for (std::size_t i = begin; i < end; ++i) {
      const Sample& sample = samples[i];
      if (!sample.is_free) continue;
      Index& near = motion.near[i];
      if (is_first) {
        const double reach = kReach * state.tolerance;
        near = state.reference.nearest(sample.place, reach, sample.parameters.normal).triangle;
      }
      forces[i] = force_on(state, options, living, samples, living.triangle[i], near, found);
    }
  });
  std::vector<Vec3> places = mesh.points;
  deform_contours(state, options, motion.previous, places);
  parallel_blocks(context, places.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    Star star;
    for (std::size_t v = begin; v < end; ++v) {
      if (mesh.incident[v] == kNoIndex || !gather_star(mesh, static_cast<Index>(v), star)) continue;
      Vec3 sum;
      for (const Index t : star.triangle) sum += forces[living.number[t]];
      places[v] += sum / static_cast<double>(star.triangle.size());
      if (!is_first) places[v] += (mesh.points[v] - motion.previous[v]) * (1 - options.damping);
    }
  });
  motion.previous = mesh.points;
  return places;
}

}  // namespace

std::vector<Vec3> deformed_places(CertifiedState& state, const DecimateOptions& options, int steps,
                                  Motion& motion, const Context& context) {
  const std::vector<Vec3> here = state.mesh.points;
  for (std::size_t v = 0; v < motion.previous.size(); ++v) {
    motion.previous[v] = here[v] + (motion.previous[v] - here[v]) / motion.steps;
  }
  motion.steps = steps;
  for (int step = 0; step < steps; ++step) {
    state.mesh.points = next_places(state, options, motion, context);
  }
  motion.previous = here;
  return std::exchange(state.mesh.points, here);
}

void deformation_pass(CertifiedState& state, Worker& worker, const std::vector<Index>& vertices,
                      const std::vector<Vec3>& places) {
  for (const Index v : vertices) {
    if (state.mesh.incident[v] == kNoIndex || state.mesh.is_locked[v]) continue;
    const Vec3 step = places[v] - state.mesh.points[v];
    if (squared_norm(step) < kLeastStep * kLeastStep * state.tolerance * state.tolerance) continue;
    for (const double part : {1.0, 0.5, 0.25}) {
      if (try_relocation(state, worker, v, state.mesh.points[v] + step * part, false)) break;
    }
  }
}

}  // namespace periost
