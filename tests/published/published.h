#pragma once
// What the published examples share: the phantoms that stand for the paper's data, and what is measured.
#include <string>

#include "pipeline/geometry/measure_quality.h"
#include "stages/decimate/decimate.h"
#include "stages/marching_cubes/marching_cubes.h"
#include "stages/phantom/phantom.h"

namespace periost::test {

inline Isosurface phantom_isosurface(PhantomShape shape, double threshold) {
  Context context;
  context.threads = 2;
  PhantomOptions options;
  options.shape = shape;
  return marching_cubes(make_phantom(options, context), {.lower = threshold}, {}, context);
}

inline DecimateOptions paper_options(double distance_voxel) {
  DecimateOptions options;
  options.method = DecimateMethod::kPaper;
  options.distance = Length::voxel(distance_voxel);
  return options;
}

inline SimplexMesh decimated(const Isosurface& isosurface, const DecimateOptions& options) {
  Context context;
  context.threads = 2;
  return decimate(isosurface, options, context);
}

// One line to read beside the paper, `published` its rate in percent.
inline void print_rate(const std::string& what, const SimplexMesh& mesh, const std::string& published) {
  std::printf("%s: %llu triangles of %llu are left, a rate of %.1f %% (published: %s)\n", what.c_str(),
              static_cast<unsigned long long>(mesh.report.triangles_after),
              static_cast<unsigned long long>(mesh.report.triangles_before), 100 * mesh.report.rate(),
              published.c_str());
}

}  // namespace periost::test
