#include "stages/improve/improve.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>

#include "pipeline/base/error.h"
#include "pipeline/geometry/measure_volume.h"
#include "pipeline/geometry/tet_faces.h"
#include "stages/improve/boundary_slide.h"
#include "stages/improve/tet_improver.h"
#include "stages/improve/tet_order.h"
#include "stages/improve/thin_split.h"

namespace periost {
namespace {

using Clock = std::chrono::steady_clock;

// Degrees: rounds without new points go to here, and so does sliding, whose checks are dear. The first slides
// leave a little more to new points, which cost less.
constexpr double kFirstTarget = 26;
constexpr double kFirstSlideTarget = 25;
// Where more than this share of tetrahedra ends below the limit, those below the target may slide, too.
constexpr double kWideShare = 0.01;
constexpr double kWideLimit = 28.5;
constexpr double kWideTarget = 29;
constexpr double kRescueLimit = 22;  // degrees: what is left below it is worth more time
// Least rise of the smallest sine for each tetrahedron that a new point brings, first and later.
constexpr double kFirstPrice = 0.008;
constexpr double kLaterPrice = 0.003;
// Least rise of the smallest sine by a move of a boundary point, first and later.
constexpr double kFirstGain = 0.04;
constexpr double kLaterGain = 0.02;

double sine_of(double degrees) {
  return std::sin(Angle::deg(degrees).radians());
}

void check_volumes(const TetMesh& mesh) {
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    const auto& [a, b, c, d] = mesh.tets[t];
    if (six_volumes(mesh.points[a], mesh.points[b], mesh.points[c], mesh.points[d]) > 0) continue;
    const Vec3 centre = 0.25 * (mesh.points[a] + mesh.points[b] + mesh.points[c] + mesh.points[d]);
    throw Error(ErrorKind::kQuality, "improve.inverted",
                fmt::format("tetrahedron {} at ({:.2f}, {:.2f}, {:.2f}) mm does not have a positive volume",
                            t, centre.x, centre.y, centre.z),
                "only a valid mesh can be improved: look at the stage before");
  }
}

// Largest distance that sliding may leave, in mm; 0: none is known, and nothing slides.
double tolerance_of(const TetMesh& mesh, const ImproveInputs& inputs, const ImproveOptions& options,
                    const Context& context) {
  if (options.boundary == BoundaryMotion::kFixed) return 0;
  double voxel_mm = mesh.voxel_mm;
  if (inputs.isosurface != nullptr && inputs.isosurface->surface.voxel_mm > 0) {
    voxel_mm = inputs.isosurface->surface.voxel_mm;
  }
  if (options.tolerance.value > 0) {
    if (options.tolerance.unit == Length::Unit::kVoxel && !(voxel_mm > 0)) {
      throw Error(ErrorKind::kUsage, "improve.no_voxel",
                  "the tolerance is given in voxels, but no image is behind the mesh",
                  "give it as a length, such as 0.1 mm");
    }
    return options.tolerance.in_mm(voxel_mm);
  }
  const double asked = inputs.simplex_mesh != nullptr ? inputs.simplex_mesh->report.requested_distance_mm : 0;
  if (!(asked > 0)) {
    context.info(
        "improve.boundary_fixed",
        "the boundary stays fixed, since no decimator tells how far it may be moved; `tolerance` does");
  }
  return asked;
}

// The mesh that the complex holds now: used points in their order, live slots in theirs.
TetMesh collect(const TetComplex& complex, const TetMesh& mesh) {
  TetMesh result;
  result.voxel_mm = mesh.voxel_mm;
  result.boundary_preserved = mesh.boundary_preserved;
  std::vector<Index> renumbered(complex.position.size(), kNoIndex);
  for (Index p = 0; p < complex.position.size(); ++p) {
    if (complex.tet_at[p] == kNoIndex) continue;
    renumbered[p] = static_cast<Index>(result.points.size());
    result.points.push_back(complex.position[p]);
  }
  for (Index t = 0; t < complex.corners.size(); ++t) {
    if (!complex.is_live(t)) continue;
    const auto& [a, b, c, d] = complex.corners[t];
    result.tets.push_back({renumbered[a], renumbered[b], renumbered[c], renumbered[d]});
    result.region.push_back(complex.region[t]);
  }
  for (const auto& [a, b, c] : mesh.boundary) {
    result.boundary.push_back({renumbered[a], renumbered[b], renumbered[c]});
  }
  if (mesh.order() == 2) add_midside_nodes(result);
  return result;
}

// Faces on the boundary and between two regions, which have two sides without neighbours.
std::size_t wall_count(const TetComplex& complex, const TetMesh& mesh) {
  std::size_t sides = 0;
  for (Index t = 0; t < complex.corners.size(); ++t) {
    if (!complex.is_live(t)) continue;
    for (const Index other : complex.neighbours[t]) sides += other == kNoIndex ? 1 : 0;
  }
  return (sides + mesh.boundary.size()) / 2;
}

// The surface that the mesh was made from, with its points where they are now: the mesher keeps its used
// points first and in order. Nothing where the boundary, with the walls of filled cavities, is not that
// surface.
std::optional<SurfaceMesh> moved_surface(const SurfaceMesh& surface, const TetMesh& before,
                                         const TetMesh& after, std::size_t walls) {
  if (!before.boundary_preserved || surface.triangles.size() != walls) return std::nullopt;
  std::vector<std::uint8_t> is_used(surface.points.size(), 0);
  for (const Triangle& triangle : surface.triangles) {
    for (const Index corner : triangle) is_used[corner] = 1;
  }
  SurfaceMesh moved = surface;
  Index next = 0;
  for (Index p = 0; p < surface.points.size(); ++p) {
    if (is_used[p] == 0) continue;
    if (next >= after.points.size() || before.points[next] != surface.points[p]) return std::nullopt;
    moved.points[p] = after.points[next++];
  }
  return moved;
}

// Dihedral angles in degrees: smallest, the value that 1 % of tetrahedra have their smallest below, largest.
struct Summary {
  double least = 180, p01 = 180, greatest = 0;
};

// Cosines of the smallest and of the largest dihedral angle.
struct Cosines {
  double of_least = -1, of_greatest = 1;
};

Cosines dihedral_cosines(const TetComplex& complex, Index tet) {
  std::array<Vec3, 4> normals;
  for (int k = 0; k < 4; ++k) {
    const auto [a, b, c] = face_of(complex.corners[tet], k);
    const auto& p = complex.position;
    normals[as_size(k)] = normalized(cross(p[b] - p[a], p[c] - p[a]));
  }
  Cosines cosines;
  for (const auto& [i, j] : kTetEdge) {
    const double cosine = -dot(normals[as_size(i)], normals[as_size(j)]);
    cosines.of_least = std::max(cosines.of_least, cosine);
    cosines.of_greatest = std::min(cosines.of_greatest, cosine);
  }
  return cosines;
}

Summary summary_of(const TetComplex& complex) {
  const auto degrees = [](double cosine) {
    return std::acos(std::clamp(cosine, -1.0, 1.0)) / Angle::deg(1).radians();
  };
  std::vector<double> cosines;  // descending: angles ascend
  double of_greatest = 1;
  for (Index t = 0; t < complex.corners.size(); ++t) {
    if (!complex.is_live(t)) continue;
    const Cosines one = dihedral_cosines(complex, t);
    cosines.push_back(one.of_least);
    of_greatest = std::min(of_greatest, one.of_greatest);
  }
  if (cosines.empty()) return {};
  const auto place = cosines.begin() + static_cast<std::ptrdiff_t>(cosines.size() / 100);
  std::nth_element(cosines.begin(), place, cosines.end(), std::greater<>());
  return {degrees(*std::max_element(cosines.begin(), place + 1)), degrees(*place), degrees(of_greatest)};
}

}  // namespace

ImproveResult improve(const TetMesh& mesh, const ImproveInputs& inputs, const ImproveOptions& options,
                      const Context& context) {
  const auto start = Clock::now();
  check_volumes(mesh);
  const double tolerance = tolerance_of(mesh, inputs, options, context);
  TetComplex complex(in_curve_order(mesh));
  const std::size_t tets_before = complex.live;
  const Summary before = summary_of(complex);

  SurfaceMesh as_it_came;
  std::optional<SlideReference> reference;
  std::unique_ptr<BoundarySlide> slide;
  if (tolerance > 0) {
    if (inputs.isosurface != nullptr && inputs.isosurface->has_voxels()) {
      reference.emplace(*inputs.isosurface);
    } else if (inputs.isosurface != nullptr) {
      reference.emplace(inputs.isosurface->surface, context);
    } else {
      as_it_came = boundary_surface(mesh);
      reference.emplace(as_it_came, context);
    }
    slide = std::make_unique<BoundarySlide>(complex, mesh.boundary, *reference, tolerance);
  }
  TetImprover improver(complex, slide.get(), options.max_growth, context);
  const double target = sine_of(options.target.degrees);
  const double first = std::min(target, sine_of(kFirstTarget));
  const auto work = [&](const char* what, const ImproveRound& round) {
    improver.round(round);
    context.debug("improve.round", fmt::format("{}: {} tetrahedra, {:.2f} s", what, complex.live,
                                               std::chrono::duration<double>(Clock::now() - start).count()));
  };
  work("without new points", {first, false, 0, false, 0});
  work("with sliding", {std::min(target, sine_of(kFirstSlideTarget)), false, 0, true, kFirstGain});
  work("with insertion", {target, true, kFirstPrice, false, 0});
  work("with all means", {first, true, 0, true, kLaterGain});
  work("with insertion", {target, true, kLaterPrice, false, 0});
  const auto is_wide = [&] {
    return slide != nullptr && improver.share_below(std::min(target, sine_of(kWideLimit))) > kWideShare;
  };
  const double wide = std::min(target, sine_of(kWideTarget));
  if (is_wide()) work("with sliding of more", {wide, false, 0, true, kLaterGain});
  if (is_wide()) work("with all means for more", {wide, true, 0, true, kLaterGain});
  improver.rescue(std::min(target, sine_of(kRescueLimit)));
  // What the rescue has left behind on a small mesh.
  if (is_wide()) work("with all means for more", {wide, true, 0, true, kLaterGain});
  if (options.split_thin) {
    const std::size_t splits = split_thin_walls(complex, improver.room());
    improver.round({target, false, 0, false, 0});
    context.info("improve.split", fmt::format("{} edges across thin walls were split", splits));
  }

  ImproveResult result;
  result.mesh = collect(complex, mesh);
  std::optional<SurfaceMesh> moved;
  if (inputs.surface != nullptr) {
    moved = moved_surface(*inputs.surface, mesh, result.mesh, wall_count(complex, mesh));
  }
  result.surface = moved ? std::move(*moved) : boundary_surface(result.mesh);
  const Summary after = summary_of(complex);
  context.info(
      "improve.done",
      fmt::format(
          "{} tetrahedra became {}; smallest dihedral angle {:.2f} deg (was {:.2f}), 1 % have one below "
          "{:.2f} ({:.2f}), largest {:.2f} ({:.2f}); {} points slid on the boundary; {:.2f} s",
          tets_before, complex.live, after.least, before.least, after.p01, before.p01, after.greatest,
          before.greatest, slide != nullptr ? slide->moved_points() : 0,
          std::chrono::duration<double>(Clock::now() - start).count()));
  return result;
}

}  // namespace periost
