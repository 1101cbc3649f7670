// Decimates one isosurface by one program and says what it took and what came out, as one line of JSON:
//   bench_decimate CASE METHOD TRIANGLES [--threads N] [--voxel D] [--rounds N] [--out FILE.vtp]
//   [--time-only]
// CASE: cranium (needs PERIOST_CRANIUM), ventricle, vessel, femur. METHOD: see kMethods. TRIANGLES: a number,
// a part of the isosurface's ("10%"), or "end", which only periost knows. Times are of the decimation alone,
// without reading, marching cubes and conversion; the least of the rounds. scripts/bench-decimate.sh runs
// them all.
#include <sys/resource.h>
#include <vtkDecimatePro.h>
#include <vtkNew.h>
#include <vtkPolyData.h>
#include <vtkQuadricDecimation.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "pipeline/base/error.h"
#include "pipeline/geometry/measure_quality.h"
#include "pipeline/geometry/simplex_dual.h"
#include "pipeline/geometry/topology.h"
#include "pipeline/io/surface_write.h"
#include "pipeline/run/clock.h"
#include "stages/decimate/decimate.h"
#include "stages/marching_cubes/marching_cubes.h"
#include "stages/phantom/phantom.h"
#include "stages/read_image/read_image.h"
#include "stages/tetgen/tetgen.h"
#include "stages/threshold/threshold.h"
#include "tests/bench/cgal_decimation.h"
#include "tests/bench/vtk_surface.h"

namespace periost {
namespace {

const KeepComponents kLargest{1};
using nlohmann::json;

double processor_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto of = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return of(usage.ru_utime) + of(usage.ru_stime);
}

// A line of /proc/self/status in bytes: VmRSS, what is resident, or VmHWM, the most that was.
double memory(const std::string& name) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with(name + ":")) return 1024 * std::stod(line.substr(name.size() + 1));
  }
  return 0;
}

// From here on VmHWM is the most from here on.
void forget_peak() {
  std::ofstream("/proc/self/clear_refs") << "5";
}

struct Job {
  Isosurface isosurface;
  std::size_t target = 0;  // triangles; 0: to the end
  double distance = 0.3;   // voxels
  unsigned threads = 2;
};

// What a method did. `seconds` are its own, without conversions.
struct Outcome {
  SurfaceMesh surface;
  double seconds = 0, processor_seconds = 0;
};

Outcome by_periost(const Job& job) {
  Context context;
  context.threads = job.threads;
  DecimateOptions options;
  options.distance = Length::voxel(job.distance);
  options.max_triangles = job.target;
  const double before = processor_seconds();
  const auto start = Clock::now();
  const SimplexMesh mesh = decimate(job.isosurface, options, context);
  const double wall = seconds_since(start), processor = processor_seconds() - before;
  return {dual_triangulation(mesh), wall, processor};
}

template <class Filter>
Outcome by_vtk(const Job& job, const std::function<void(Filter*)>& set_up) {
  vtkNew<vtkPolyData> data = to_vtk(job.isosurface.surface);
  vtkNew<Filter> filter;
  filter->SetInputData(data);
  filter->SetTargetReduction(1 - static_cast<double>(job.target) /
                                     static_cast<double>(job.isosurface.surface.triangles.size()));
  set_up(filter);
  const double before = processor_seconds();
  const auto start = Clock::now();
  filter->Update();
  const double wall = seconds_since(start), processor = processor_seconds() - before;
  data->GetPolys()->InitTraversal();
  filter->GetOutput()->GetPolys()->InitTraversal();
  return {from_vtk(filter->GetOutput(), job.isosurface.surface.voxel_mm), wall, processor};
}

Outcome by_quadric(const Job& job) {
  return by_vtk<vtkQuadricDecimation>(job,
                                      [](vtkQuadricDecimation* filter) { filter->VolumePreservationOn(); });
}

Outcome by_decimate_pro(const Job& job) {
  return by_vtk<vtkDecimatePro>(job, [](vtkDecimatePro* filter) { filter->PreserveTopologyOn(); });
}

Outcome by_cgal(const Job& job, CgalMethod method) {
  Outcome outcome;
  const double before = processor_seconds();
  outcome.surface = cgal_decimated(job.isosurface.surface, method, job.target, outcome.seconds);
  outcome.processor_seconds = processor_seconds() - before;
  return outcome;
}

const std::map<std::string, std::function<Outcome(const Job&)>> kMethods{
    {"periost", by_periost},
    {"vtkQuadricDecimation", by_quadric},
    {"vtkDecimatePro", by_decimate_pro},
    {"cgal_collapse", [](const Job& job) { return by_cgal(job, CgalMethod::kLindstromTurk); }},
    {"cgal_quadric", [](const Job& job) { return by_cgal(job, CgalMethod::kGarlandHeckbert); }},
    {"cgal_remesh", [](const Job& job) { return by_cgal(job, CgalMethod::kIsotropic); }}};

Isosurface phantom_isosurface(PhantomShape shape, double threshold_value, const Context& context) {
  PhantomOptions options;
  options.shape = shape;
  const Image image = make_phantom(options, context);
  const Mask mask = threshold(image, {.lower = threshold_value}, context);
  return marching_cubes(&image, mask, {}, context);
}

Isosurface cranium_isosurface(const Context& context) {
  const char* path = std::getenv("PERIOST_CRANIUM");
  if (path == nullptr) {
    throw Error(ErrorKind::kUsage, "bench.cranium", "PERIOST_CRANIUM is not set",
                "scripts/fetch_data.sh prints it");
  }
  const Image image = read_image({.path = path}, context);
  const Mask mask = threshold(image, {.lower = 226, .keep = kLargest}, context);
  return marching_cubes(&image, mask, {.keep = kLargest}, context);
}

Isosurface isosurface_of(const std::string& name, const Context& context) {
  if (name == "cranium") return cranium_isosurface(context);
  if (name == "ventricle") return phantom_isosurface(PhantomShape::kVentricle, 0.5, context);
  if (name == "vessel") return phantom_isosurface(PhantomShape::kVessel, 190, context);
  if (name == "femur") return phantom_isosurface(PhantomShape::kFemur, 226, context);
  throw Error(ErrorKind::kUsage, "bench.case", "no case '" + name + "'",
              "cranium, ventricle, vessel or femur");
}

// "accepted" with the number of tetrahedra, or the code of the refusal.
json tetgen_answer(const SurfaceMesh& surface) {
  Context context;
  context.workers = PERIOST_BUILD_DIR "/bin";
  try {
    return tetrahedralize(surface, {}, context).tets.size();
  } catch (const Error& error) {
    return error.code();
  }
}

json judge(const Job& job, const SurfaceMesh& surface) {
  Context context;
  context.threads = job.threads;
  QualityInputs inputs;
  inputs.isosurface = &job.isosurface.surface;
  inputs.surface = &surface;
  inputs.voxel_mm = job.isosurface.surface.voxel_mm;
  const SurfaceQuality q = *measure_quality(inputs, {}, context).report.surface;
  const Topology topology = examine_topology(surface);
  json said = {{"triangles", q.triangles},
               {"min_angle", q.min_angle_deg.min},
               {"p01_angle", q.min_angle_deg.p01},
               {"below_20", q.share_below_20deg},
               {"outward", q.distance->surface_to_isosurface.max},
               {"back", q.distance->isosurface_to_surface.max},
               {"non_manifold", topology.violations(Violation::kNonManifoldEdge) +
                                    topology.violations(Violation::kPinchedVertex)},
               {"self_intersections", q.self_intersections},
               {"tetgen", tetgen_answer(surface)}};
  if (q.volume_change) said["volume_change"] = *q.volume_change;
  return said;
}

std::size_t target_of(const std::string& text, std::size_t triangles) {
  if (text == "end") return 0;
  const double number = std::stod(text);
  return static_cast<std::size_t>(text.back() == '%' ? number / 100 * static_cast<double>(triangles)
                                                     : number);
}

int run(const std::vector<std::string>& arguments) {
  if (arguments.size() < 3 || !kMethods.contains(arguments[1])) {
    std::cerr
        << "usage: bench_decimate CASE METHOD TRIANGLES [--threads N] [--voxel D] [--rounds N] [--out FILE] "
           "[--time-only]\n";
    return 2;
  }
  Job job;
  std::string out;
  int rounds = 1;
  bool is_judged = true;
  for (std::size_t i = 3; i < arguments.size(); ++i) {
    if (arguments[i] == "--time-only")
      is_judged = false;
    else if (i + 1 == arguments.size())
      throw std::invalid_argument(arguments[i]);
    else if (arguments[i] == "--threads")
      job.threads = static_cast<unsigned>(std::stoul(arguments[++i]));
    else if (arguments[i] == "--voxel")
      job.distance = std::stod(arguments[++i]);
    else if (arguments[i] == "--rounds")
      rounds = std::stoi(arguments[++i]);
    else if (arguments[i] == "--out")
      out = arguments[++i];
    else
      throw std::invalid_argument(arguments[i]);
  }
  Context context;
  context.threads = job.threads;
  job.isosurface = isosurface_of(arguments[0], context);
  job.target = target_of(arguments[2], job.isosurface.surface.triangles.size());
  json said = {
      {"case", arguments[0]}, {"method", arguments[1]}, {"before", job.isosurface.surface.triangles.size()}};
  forget_peak();
  const double held = memory("VmRSS");
  Outcome best;
  for (int round = 0; round < rounds; ++round) {
    Outcome outcome = kMethods.at(arguments[1])(job);
    if (round == 0) said["peak_bytes"] = memory("VmHWM") - held;
    if (round == 0 || outcome.seconds < best.seconds) best = std::move(outcome);
  }
  said["seconds"] = best.seconds;
  said["processor_seconds"] = best.processor_seconds;
  said["triangles"] = best.surface.triangles.size();
  if (!out.empty()) write_surface(best.surface, out);
  if (is_judged) said.update(judge(job, best.surface));
  std::cout << said.dump() << "\n";
  return 0;
}

}  // namespace
}  // namespace periost

int main(int count, char** values) {
  try {
    return periost::run({values + 1, values + count});
  } catch (const periost::Error& error) {
    std::cerr << "error: " << error.what() << "\n";
  } catch (const std::exception& error) {
    std::cerr << "error: bad argument: " << error.what() << "\n";
  }
  return 1;
}
