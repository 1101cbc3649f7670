#include "stages/tetgen/tetgen.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include "pipeline/base/error.h"
#include "pipeline/geometry/tet_faces.h"
#include "pipeline/io/image_read.h"
#include "stages/tetgen/bodies.h"
#include "stages/tetgen/reached.h"
#include "stages/tetgen/sizes.h"
#include "stages/tetgen/surface_check.h"
#include "stages/tetgen/worker_client.h"

namespace periost {
namespace {

using periost_tetgen::Status;
using Clock = std::chrono::steady_clock;

// TetGen's own tests are not exact; what fails with its usual tolerance may pass with a finer one, or
// without the optimisation at the end.
struct Attempt {
  double tolerance;
  bool is_optimised;
};
constexpr Attempt kAttempts[] = {{1e-8, true}, {1e-12, true}, {1e-12, false}};

// The surface as the worker gets it: only the points in use, moved near the origin, where TetGen's tolerances
// are finest.
struct Centred {
  std::vector<Index> original;  // per point in use, its index in the surface
  SurfaceMesh surface;
  Vec3 centre;
};

// The middle of the box, rounded to few bits, so that subtracting it seldom rounds.
Vec3 round_centre(const SurfaceMesh& surface) {
  Vec3 centre;
  for (std::size_t k = 0; k < 3; ++k) {
    double low = surface.points[surface.triangles[0][0]][k], high = low;
    for (const Triangle& triangle : surface.triangles) {
      for (const Index corner : triangle) {
        low = std::min(low, surface.points[corner][k]);
        high = std::max(high, surface.points[corner][k]);
      }
    }
    const double step = high > low ? std::exp2(std::floor(std::log2(high - low)) - 2) : 0;
    centre[k] = step > 0 ? std::round(0.5 * (low + high) / step) * step : low;
  }
  return centre;
}

Centred centred(const SurfaceMesh& surface) {
  Centred result;
  result.surface.voxel_mm = surface.voxel_mm;
  result.centre = round_centre(surface);
  std::vector<Index> renumbered(surface.points.size(), kNoIndex);
  for (const Triangle& triangle : surface.triangles) {
    for (const Index corner : triangle) renumbered[corner] = 0;
  }
  for (Index p = 0; p < surface.points.size(); ++p) {
    if (renumbered[p] == kNoIndex) continue;
    renumbered[p] = static_cast<Index>(result.surface.points.size());
    result.original.push_back(p);
    result.surface.points.push_back(surface.points[p] - result.centre);
  }
  for (const auto& [a, b, c] : surface.triangles) {
    result.surface.triangles.push_back({renumbered[a], renumbered[b], renumbered[c]});
  }
  return result;
}

// The tighter of the two limits; 0: none.
std::uint64_t memory_limit(const TetgenOptions& options, const Context& context) {
  const std::uint64_t own = options.memory_limit.bytes, given = context.memory_bytes;
  return own == 0 || given == 0 ? std::max(own, given) : std::min(own, given);
}

periost_tetgen::SizeGrid asked_sizes(const Centred& input, const TetgenOptions& options,
                                     const Context& context) {
  std::optional<Image> field;
  if (!options.sizes.field.empty()) field = read_image(options.sizes.field, {}, context);
  return make_size_grid(input.surface, input.centre, options, field ? &*field : nullptr, context);
}

bool is_worth_another_attempt(Status status) {
  return status == Status::kBug || status == Status::kSelfIntersection || status == Status::kTinyFeature ||
         status == Status::kNearlyCoplanar || status == Status::kNothing;
}

[[noreturn]] void fail(const WorkerReply& reply, const TetgenOptions& options, const Context& context) {
  if (reply.status == Status::kMemory) {
    const std::uint64_t limit = memory_limit(options, context);
    throw Error(ErrorKind::kLimit, "tetgen.memory",
                limit > 0 ? fmt::format("TetGen needs more than the {} of memory it was given",
                                        to_text(ByteSize{limit}))
                          : "TetGen ran out of memory",
                "raise --memory or memory_limit, decimate further, or ask for larger tetrahedra");
  }
  if (reply.status == Status::kTimeLimit) {
    throw Error(ErrorKind::kLimit, "tetgen.time",
                fmt::format("TetGen was stopped after {} s", to_text(options.time_limit)),
                "raise time_limit, or ask for less: max_radius_edge above 1.3, min_dihedral of 10 or less");
  }
  throw Error(ErrorKind::kExternal, "tetgen.failed", reply.message,
              "the surface passed our exact checks, so it is at the limit of TetGen's tolerances: decimate "
              "with a larger smallest angle, or smooth the surface");
}

WorkerReply mesh_with_attempts(WorkerRequest& request, const TetgenOptions& options, const Context& context) {
  const auto deadline = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                           std::chrono::duration<double>(options.time_limit));
  WorkerReply reply;
  for (const Attempt& attempt : kAttempts) {
    request.header.tolerance = attempt.tolerance;
    request.header.optimise_deg = attempt.is_optimised ? options.optimise.degrees : 0;
    // The clock on the wall decides; the limit of processor time stops a worker that outlived us.
    request.header.cpu_seconds = options.time_limit + 5;
    reply = run_worker(request, deadline, context);
    if (!is_worth_another_attempt(reply.status)) break;
    context.warn("tetgen.attempt_failed",
                 fmt::format("{} (tolerance {})", reply.message, to_text(attempt.tolerance)));
  }
  if (reply.status != Status::kDone) fail(reply, options, context);
  return reply;
}

TetMesh take_mesh(WorkerReply&& reply, const Centred& input, const SurfaceMesh& surface) {
  TetMesh mesh;
  mesh.voxel_mm = surface.voxel_mm;
  mesh.tets = std::move(reply.tets);
  mesh.points = std::move(reply.points);
  const std::size_t given = input.surface.points.size();
  const bool are_kept =
      mesh.points.size() >= given &&
      std::equal(input.surface.points.begin(), input.surface.points.end(), mesh.points.begin());
  for (std::size_t p = 0; p < mesh.points.size(); ++p) {
    // Moving back would round: the surface's own points return with their bits.
    mesh.points[p] =
        are_kept && p < given ? surface.points[input.original[p]] : mesh.points[p] + input.centre;
  }
  return mesh;
}

std::vector<Triangle> sorted_triangles(std::vector<Triangle> triangles) {
  for (Triangle& triangle : triangles) std::sort(triangle.begin(), triangle.end());
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

// The faces on the boundary and between regions.
std::vector<Triangle> walls(const TetMesh& mesh, const std::vector<TetNeighbours>& neighbours) {
  std::vector<Triangle> faces = faces_between_regions(mesh, neighbours);
  faces.insert(faces.end(), mesh.boundary.begin(), mesh.boundary.end());
  return faces;
}

// Each body takes the number of the shell that its first surface point belongs to.
std::vector<std::int32_t> regions(const TetMesh& mesh, const std::vector<TetNeighbours>& neighbours,
                                  const Centred& input, const Bodies& bodies) {
  std::vector<std::int32_t> number_of_point(mesh.points.size(), 0);
  for (std::size_t t = 0; t < input.surface.triangles.size(); ++t) {
    for (const Index corner : input.surface.triangles[t]) {
      number_of_point[corner] = bodies.number[bodies.shell_of_triangle[t]];
    }
  }
  const std::vector<std::uint32_t> component = tet_components(neighbours);
  std::vector<std::int32_t> number;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    if (component[t] >= number.size()) number.resize(component[t] + 1, 0);
    for (const Index corner : mesh.tets[t]) {
      if (number[component[t]] == 0) number[component[t]] = number_of_point[corner];
    }
  }
  std::vector<std::int32_t> region(mesh.tets.size());
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) region[t] = number[component[t]];
  return region;
}

void log_bodies(const Bodies& bodies, const TetgenOptions& options, const Context& context) {
  const std::size_t cavities = bodies.depth.size() - bodies.body_count();
  context.info("tetgen.bodies",
               fmt::format("{} bodies, {} cavities{}", bodies.body_count(), cavities,
                           cavities > 0 && options.cavities == Cavities::kFilled ? ", filled" : ""));
  if (bodies.turned_shells > 0) {
    context.warn("tetgen.turned_shells",
                 fmt::format("{} shells have normals that contradict how they are nested; nesting decides "
                             "what is body and what is cavity",
                             bodies.turned_shells));
  }
}

void log_result(const TetMesh& mesh, double seconds, const Context& context) {
  context.info("tetgen.done",
               fmt::format("{} tetrahedra, {} points in {:.1f} s; surface {}", mesh.tets.size(),
                           mesh.points.size(), seconds, mesh.boundary_preserved ? "kept" : "changed"));
}

}  // namespace

TetMesh tetrahedralize(const SurfaceMesh& surface, const TetgenOptions& options, const Context& context) {
  const auto start = Clock::now();
  check_fillable(surface, context);
  const Centred input = centred(surface);
  // In the coordinates that TetGen gets, so that the seeds lie in the cavities as it sees them.
  const Bodies bodies = find_bodies(input.surface, options.cavities, context);
  log_bodies(bodies, options, context);

  WorkerRequest request;
  request.header.flags = options.preserve_surface ? periost_tetgen::kPreserveSurface : 0;
  request.header.max_radius_edge = options.max_radius_edge;
  request.header.min_dihedral_deg = options.min_dihedral.degrees;
  request.header.max_volume = options.max_volume;
  request.header.memory_bytes = memory_limit(options, context);
  request.points = input.surface.points;
  request.triangles = input.surface.triangles;
  request.holes = bodies.cavity_seeds;
  request.region_seeds = bodies.region_seeds;
  if (options.sizes.is_any()) request.sizes = asked_sizes(input, options, context);

  WorkerReply reply = mesh_with_attempts(request, options, context);
  log_reached(reply.points, reply.tets, input.surface.points.size(), options, request.sizes, context);
  const std::vector<std::uint32_t> seed_of_tet = std::move(reply.seed_of_tet);
  TetMesh mesh = take_mesh(std::move(reply), input, surface);
  const std::vector<TetNeighbours> neighbours = tet_neighbours(mesh.tets, mesh.points.size());
  for (const BoundaryFace& face : boundary_faces(neighbours)) {
    mesh.boundary.push_back(face_of(mesh.tets[face.tet], face.opposite));
  }
  if (seed_of_tet.empty()) {
    mesh.region = regions(mesh, neighbours, input, bodies);
  } else {
    for (const std::uint32_t seed : seed_of_tet) mesh.region.push_back(bodies.number.at(seed));
  }
  mesh.boundary_preserved =
      sorted_triangles(walls(mesh, neighbours)) == sorted_triangles(input.surface.triangles);
  if (options.order == 2) add_midside_nodes(mesh);
  log_result(mesh, std::chrono::duration<double>(Clock::now() - start).count(), context);
  return mesh;
}

}  // namespace periost
