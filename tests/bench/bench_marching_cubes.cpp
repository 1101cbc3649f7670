// Marching cubes with its voxel structure, threshold and queries, beside vtkFlyingEdges3D; on one thread and
// on two.
#include <benchmark/benchmark.h>
#include <oneapi/tbb/global_control.h>
#include <vtkFlyingEdges3D.h>
#include <vtkImageImport.h>
#include <vtkNew.h>
#include <vtkPolyData.h>

#include <map>

#include "pipeline/base/random.h"
#include "pipeline/geometry/isosurface_query.h"
#include "stages/marching_cubes/marching_cubes.h"
#include "stages/phantom/phantom.h"
#include "stages/threshold/threshold.h"

namespace periost {
namespace {

constexpr double kThreshold = 226;

const Image& femur_image(std::int32_t side) {
  static std::map<std::int32_t, Image> images;
  auto found = images.find(side);
  if (found == images.end()) {
    const double spacing = 460.0 / side;
    found = images
                .emplace(side, make_phantom({.shape = PhantomShape::kFemur,
                                             .size = {{side, side, side}},
                                             .spacing = Vec3{100.0 / side, 80.0 / side, spacing}},
                                            {}))
                .first;
  }
  return found->second;
}

void report(benchmark::State& state, std::size_t voxels, std::size_t triangles) {
  const auto rounds = static_cast<double>(state.iterations());
  state.counters["Mvoxel/s"] =
      benchmark::Counter(1e-6 * static_cast<double>(voxels) * rounds, benchmark::Counter::kIsRate);
  state.counters["Mtri/s"] =
      benchmark::Counter(1e-6 * static_cast<double>(triangles) * rounds, benchmark::Counter::kIsRate);
  state.counters["triangles"] = static_cast<double>(triangles);
}

void threshold_stage(benchmark::State& state) {
  const Image& image = femur_image(static_cast<std::int32_t>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(threshold(image, {.lower = kThreshold}, {}));
  report(state, image.values.size(), 0);
}
BENCHMARK(threshold_stage)->Arg(256)->Unit(benchmark::kMillisecond);

void marching_cubes_stage(benchmark::State& state) {
  const Image& image = femur_image(static_cast<std::int32_t>(state.range(0)));
  const Mask mask = threshold(image, {.lower = kThreshold}, {});
  std::size_t triangles = 0;
  Context context;
  context.threads = static_cast<int>(state.range(1));
  for (auto _ : state) triangles = marching_cubes(&image, mask, {}, context).surface.triangles.size();
  report(state, image.values.size(), triangles);
}
BENCHMARK(marching_cubes_stage)->Args({256, 1})->Args({256, 2})->Unit(benchmark::kMillisecond)->UseRealTime();

void vtk_flying_edges(benchmark::State& state) {
  const Image& image = femur_image(static_cast<std::int32_t>(state.range(0)));
  const auto& [nx, ny, nz] = image.frame.dims;
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(state.range(1)));
  vtkNew<vtkImageImport> import;
  import->SetImportVoidPointer(const_cast<float*>(image.values.data()));
  import->SetDataScalarTypeToFloat();
  import->SetNumberOfScalarComponents(1);
  import->SetWholeExtent(0, nx - 1, 0, ny - 1, 0, nz - 1);
  import->SetDataExtentToWholeExtent();
  import->Update();
  std::size_t triangles = 0;
  for (auto _ : state) {
    vtkNew<vtkFlyingEdges3D> edges;
    edges->SetInputConnection(import->GetOutputPort());
    edges->SetValue(0, kThreshold);
    edges->ComputeNormalsOff();
    edges->ComputeScalarsOff();
    edges->Update();
    triangles = static_cast<std::size_t>(edges->GetOutput()->GetNumberOfPolys());
  }
  report(state, image.values.size(), triangles);
}
BENCHMARK(vtk_flying_edges)->Args({256, 1})->Args({256, 2})->Unit(benchmark::kMillisecond)->UseRealTime();

// Points half a voxel around the surface, in the order of the surface, as decimation asks.
void query(benchmark::State& state, bool along_line) {
  const Image& image = femur_image(256);
  const Isosurface isosurface = marching_cubes(image, {.lower = kThreshold}, {}, Context());
  const auto& mesh = isosurface.surface;
  const double voxel = mesh.voxel_mm;
  Random random(1, 0);
  Index t = 0;
  for (auto _ : state) {
    const auto& [a, b, c] = mesh.triangles[t];
    const Vec3 normal = normalized(cross(mesh.points[b] - mesh.points[a], mesh.points[c] - mesh.points[a]));
    const Vec3 p = mesh.points[a] + normal * ((random.uniform() - 0.5) * voxel);
    if (along_line) {
      benchmark::DoNotOptimize(closest_along_line(isosurface, p, normal, voxel));
    } else {
      benchmark::DoNotOptimize(closest_point(isosurface, p, voxel));
    }
    t = t + 7 < mesh.triangles.size() ? t + 7 : 0;
  }
}
BENCHMARK_CAPTURE(query, closest_along_line, true);
BENCHMARK_CAPTURE(query, closest_point, false);

}  // namespace
}  // namespace periost

BENCHMARK_MAIN();
