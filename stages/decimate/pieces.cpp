#include "stages/decimate/pieces.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "pipeline/base/error.h"
#include "pipeline/base/parallel.h"
#include "pipeline/base/random.h"
#include "pipeline/geometry/simplex_dual.h"
#include "stages/decimate/law_of_motion.h"
#include "stages/decimate/paper.h"

namespace periost {
namespace {

// How many edges from the seam edges are unprocessed at first. What lies further was tried in its piece with
// all of its neighbourhood free to move.
constexpr int kSeamExtent = 4;

// A component's triangles, contour vertices not among them, and whether it was decimated in a piece.
struct ComponentState {
  int triangles = 0;
  bool was_decimated = false;
};

std::vector<ComponentState> component_states(const ContouredMesh& model, const SimplexComponents& components,
                                             const std::vector<std::uint8_t>& was_decimated) {
  std::vector<ComponentState> states(components.count);
  for (std::uint32_t v = 0; v < components.of_vertex.size(); ++v) {
    ComponentState& state = states[components.of_vertex[v]];
    state.triangles += model.contours.is_on_contour(SimplexVertex{v}) ? 0 : 1;
    state.was_decimated = state.was_decimated || was_decimated[v] != 0;
  }
  return states;
}

// Where the joined mesh is to be decimated: around the seams, and in parts that were too small in their
// piece.
std::vector<std::uint8_t> start_of(const ContouredMesh& model, const std::vector<SimplexVertex>& seam,
                                   const std::vector<std::uint8_t>& was_decimated,
                                   const std::vector<std::uint8_t>& was_cut) {
  std::vector<std::uint8_t> start(model.mesh.face.size(), 0);
  MotionMarks marks(start.size());
  std::vector<SimplexVertex> near;
  gather_neighbourhood(model.mesh, seam, kSeamExtent, marks, near);
  for (const SimplexVertex v : near) start[index_of(v)] = 1;
  for (std::size_t v = 0; v < start.size(); ++v) {
    if (was_decimated[v] == 0 && was_cut[v] != 0) start[v] = 1;
  }
  return start;
}

// A seed of its own for each piece and for the seams.
std::uint64_t seed_of(std::uint64_t seed, std::uint64_t number) {
  return Random(seed, number).next();
}

}  // namespace

Piece decimate_piece(const Isosurface& isosurface, const CutPlanes& planes, std::size_t number,
                     const DecimateOptions& options, double distance_mm, std::uint64_t seed,
                     const Context& context) {
  Piece piece;
  const Isosurface part = cut_part(isosurface, planes, number);
  if (part.surface.triangles.empty()) return piece;
  piece.model.mesh = dual_simplex_mesh(part.surface);
  piece.model.contours = close_contours(piece.model.mesh, part.frame);
  const SimplexComponents components = components_of(piece.model.mesh);
  std::vector<int> triangles(components.count, 0);
  for (std::size_t v = 0; v < part.surface.triangles.size(); ++v) ++triangles[components.of_vertex[v]];
  for (const std::uint32_t c : components.of_vertex)
    piece.was_decimated.push_back(triangles[c] >= options.small_triangles ? 1 : 0);

  Context inner;  // pieces are what runs in parallel
  inner.cancelled = context.cancelled;
  decimate_paper(part, options, distance_mm, seed_of(seed, number), {}, piece.model, inner);
  std::size_t kept = 0;
  for (std::uint32_t v = 0; v < piece.was_decimated.size(); ++v) {
    if (piece.model.mesh.is_live(SimplexVertex{v})) piece.was_decimated[kept++] = piece.was_decimated[v];
  }
  piece.was_decimated.resize(kept);
  compact(piece.model.mesh, piece.model.contours);
  return piece;
}

SimplexMesh join_pieces(const Isosurface& isosurface, std::vector<Piece> pieces,
                        const DecimateOptions& options, double distance_mm, std::uint64_t seed,
                        Context& context) {
  std::vector<ContouredMesh> parts;
  std::vector<std::uint8_t> flags, cuts;  // of inner vertices, whose order sewing keeps
  DecimationReport report;
  report.pieces = static_cast<std::uint32_t>(pieces.size());
  for (Piece& piece : pieces) {
    ContouredMesh& model = piece.model;
    add_counts(report, model.mesh.report);
    const SimplexComponents components = components_of(model.mesh);
    std::vector<std::uint8_t> is_cut(components.count, 0);
    for (std::size_t v = 0; v < model.contours.side.size(); ++v) {
      if (model.contours.side[v] == kFixedContour) is_cut[components.of_vertex[v]] = 1;
    }
    for (std::uint32_t v = 0; v < model.mesh.face.size(); ++v) {
      if (model.contours.is_on_contour(SimplexVertex{v})) continue;
      flags.push_back(piece.was_decimated[v]);
      cuts.push_back(is_cut[components.of_vertex[v]]);
    }
    parts.push_back(std::move(model));
  }
  SewnMesh sewn = sew(parts);
  parts.clear();
  ContouredMesh& whole = sewn.whole;
  std::vector<std::uint8_t> was_decimated, was_cut;
  for (std::uint32_t v = 0, inner = 0; v < whole.mesh.face.size(); ++v) {
    const bool is_inner = !whole.contours.is_on_contour(SimplexVertex{v});
    was_decimated.push_back(is_inner ? flags[inner] : 0);
    was_cut.push_back(is_inner ? cuts[inner] : 0);
    inner += is_inner ? 1 : 0;
  }
  std::vector<std::uint8_t> start = start_of(whole, sewn.seam, was_decimated, was_cut);
  const SimplexComponents components = components_of(whole.mesh);
  const auto states = component_states(whole, components, was_decimated);
  for (std::size_t v = 0; v < start.size(); ++v) {
    const ComponentState& state = states[components.of_vertex[v]];
    if (state.triangles < options.small_triangles && !state.was_decimated) start[v] = 0;
  }
  if (!start.empty())
    decimate_paper(isosurface, options, distance_mm, seed_of(seed, pieces.size()), start, whole, context);
  add_counts(report, whole.mesh.report);
  open_contours(whole.mesh, whole.contours);
  compact(whole.mesh);
  whole.mesh.voxel_mm = isosurface.surface.voxel_mm;
  whole.mesh.report = report;
  return std::move(whole.mesh);
}

SimplexMesh decimate_in_pieces(const Isosurface& isosurface, std::uint32_t pieces,
                               const DecimateOptions& options, double distance_mm, std::uint64_t seed,
                               Context& context) {
  const CutPlanes planes = choose_cut(isosurface, pieces);
  context.info("decimate.pieces", fmt::format("cut across axis {} at the voxels {}", "ijk"[planes.axis],
                                              fmt::join(planes.at, ", ")));
  std::vector<Piece> done(planes.at.size() + 1);
  {
    Progress progress(context, "decimate pieces", done.size());
    parallel_for(context, done.size(), [&](std::size_t i) {
      done[i] = decimate_piece(isosurface, planes, i, options, distance_mm, seed, context);
      progress.step();
    });
  }
  return join_pieces(isosurface, std::move(done), options, distance_mm, seed, context);
}

}  // namespace periost
