#include "stages/decimate/certified_pieces.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>

#include "pipeline/base/error.h"
#include "pipeline/base/quantity.h"
#include "pipeline/geometry/isosurface_cut.h"

namespace periost {
namespace {

constexpr double kBandVoxels = 16;    // half the width of a band, in largest voxel sides
constexpr double kOnCut = 1e-6;       // voxels
constexpr double kInsideSlab = 1e-3;  // voxels that free vertices keep from a slab's planes

// A proof of an isosurface triangle near a seam, by numbers of the whole.
struct BandProof {
  Index iso;
  ReverseProof proof;
};

// The decimated whole, and what the bands need of it. Dead triangles have kNoIndex as their first corner.
struct Joined {
  std::vector<Vec3> points;
  std::vector<Index> nearest;     // of points: isosurface triangle
  std::vector<Quadric> quadrics;  // of points, about the isosurface's first point
  std::vector<std::uint8_t> blocked_by;
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> uses;  // of triangles: isosurface triangles whose proofs name it
  std::vector<std::vector<BandProof>> bands;
  MoveCounts counts;
  Vec3 lo{-1e300, -1e300, -1e300}, hi{1e300, 1e300, 1e300};  // borders that inner vertices keep from
};

// The planes, and how far a band reaches from each.
struct Cut {
  CutPlanes planes;
  std::vector<std::int32_t> reach;

  bool is_in_band(std::size_t seam, std::int32_t cell) const {
    return cell >= planes.at[seam] - reach[seam] && cell < planes.at[seam] + reach[seam];
  }
};

Cut make_cut(const Isosurface& isosurface, std::uint32_t pieces) {
  Cut cut{choose_cut(isosurface, pieces), {}};
  const auto& at = cut.planes.at;
  const auto axis = static_cast<std::size_t>(cut.planes.axis);
  const GridFrame& frame = isosurface.frame;
  const int wanted = static_cast<int>(std::ceil(kBandVoxels * frame.largest_spacing() / frame.spacing[axis]));
  for (std::size_t i = 0; i < at.size(); ++i) {
    // The planes of a band are planes of the image, and bands do not touch.
    int reach = std::min({wanted, at[i] - 1, frame.dims[axis] - 2 - at[i]});
    if (i > 0) reach = std::min(reach, (at[i] - at[i - 1]) / 2);
    if (i + 1 < at.size()) reach = std::min(reach, (at[i + 1] - at[i]) / 2);
    cut.reach.push_back(std::max(reach, 0));
  }
  return cut;
}

// Calls visit(triangle, cell index along the axis) for the triangles of cells first .. last - 1, in order.
template <class Visit>
void for_triangles_between(const Isosurface& isosurface, int axis, std::int32_t first, std::int32_t last,
                           Visit&& visit) {
  constexpr int kSide = CellBlock::kSide;
  for (const CellBlock& block : isosurface.blocks) {
    for (int c = 0; c < CellBlock::kCells; ++c) {
      const int offset = axis == 0 ? c % kSide : axis == 1 ? c / kSide % kSide : c / (kSide * kSide);
      const std::int32_t cell = block.first_cell[static_cast<std::size_t>(axis)] + offset;
      if (cell < first || cell >= last) continue;
      const auto at = static_cast<std::size_t>(c);
      for (Index t = block.first[at]; t < block.first[at + 1]; ++t) visit(block.first_triangle + t, cell);
    }
  }
}

// The triangles of a part, by the whole's numbers, and their cells along the axis.
struct PartTriangles {
  std::vector<Index> number;
  std::vector<std::int32_t> cell;
};
PartTriangles triangles_of_part(const Isosurface& isosurface, const CutPlanes& planes, std::size_t part) {
  PartTriangles found;
  const std::int32_t first = part == 0 ? -1 : planes.at[part - 1];
  const std::int32_t last = part < planes.at.size()
                                ? planes.at[part]
                                : isosurface.frame.dims[static_cast<std::size_t>(planes.axis)];
  for_triangles_between(isosurface, planes.axis, first, last, [&](Index t, std::int32_t cell) {
    found.number.push_back(t);
    found.cell.push_back(cell);
  });
  return found;
}

// Moves the origin of a quadric by `by`.
Quadric moved_origin(const Quadric& q, Vec3 by) {
  Quadric moved = q;
  moved.b = q.b + q.times(by);
  moved.c = q.at(by);
  return moved;
}

// Of points of the isosurface: whether their component has fewer triangles than asked.
std::vector<std::uint8_t> small_components(const Isosurface& isosurface, std::size_t least) {
  std::vector<Index> parent(isosurface.surface.points.size());
  std::iota(parent.begin(), parent.end(), Index{0});
  const auto root = [&](Index p) {
    while (parent[p] != p) p = parent[p] = parent[parent[p]];
    return p;
  };
  for (const Triangle& t : isosurface.surface.triangles) {
    for (const Index p : {t[1], t[2]}) {
      const Index a = root(t[0]), b = root(p);
      parent[std::max(a, b)] = std::min(a, b);
    }
  }
  std::vector<Index> count(parent.size(), 0);
  for (const Triangle& t : isosurface.surface.triangles) ++count[root(t[0])];
  std::vector<std::uint8_t> is_small(parent.size());
  for (Index p = 0; p < parent.size(); ++p) is_small[p] = count[root(p)] < least ? 1 : 0;
  return is_small;
}

// Locks the cut contours of a piece, whose quadrics are then the surface's alone.
void lock_cuts(const Cut& cut, CertifiedState& state) {
  CertifiedMesh& mesh = state.mesh;
  const auto axis = static_cast<std::size_t>(cut.planes.axis);
  for (Index v = 0; v < mesh.points.size(); ++v) {
    if (!mesh.is_on_contour(v)) continue;
    const double q = state.reference.frame().to_index(mesh.points[v])[axis];
    const bool is_cut = std::any_of(cut.planes.at.begin(), cut.planes.at.end(),
                                    [&](std::int32_t c) { return std::abs(q - c) < kOnCut; });
    if (!is_cut) continue;
    mesh.is_locked[v] = 1;
    state.quadrics[v] = {};
  }
  for (Index t = 0; t < state.reference.triangles.size(); ++t) {
    const auto c = state.reference.corners(t);
    Quadric plane;
    plane.add_plane(state.reference.normals[t], c[0] - state.reference.points[0],
                    norm(cross(c[1] - c[0], c[2] - c[0])) / 6);
    for (const Index v : state.reference.triangles[t].corner) {
      if (mesh.is_locked[v] && mesh.is_on_contour(v)) state.quadrics[v] += plane;
    }
  }
}

// Bounds a piece by its cuts, so that it does not reach into others.
void keep_between_cuts(const CutPlanes& planes, std::size_t part, CertifiedContours& contours) {
  const auto axis = static_cast<std::size_t>(planes.axis);
  if (part > 0) {
    contours.cut_lo[axis] = planes.at[part - 1];
    contours.lo[axis] = std::max(contours.lo[axis], contours.cut_lo[axis]);
  }
  if (part < planes.at.size()) {
    contours.cut_hi[axis] = planes.at[part];
    contours.hi[axis] = std::min(contours.hi[axis], contours.cut_hi[axis]);
  }
}

void drop_triangles(const std::vector<std::uint8_t>& is_small, const Isosurface& isosurface,
                    const std::vector<Index>& whole, CertifiedState& state) {
  for (Index t = 0; t < whole.size(); ++t) {
    if (is_small[isosurface.surface.triangles[whole[t]][0]]) drop_triangle(t, state.mesh, state.proofs);
  }
}

// Joins points on cuts by their places.
class CutPoints {
 public:
  // The number of the point with exactly this place, or kNoIndex; then it is `fresh` from now on.
  Index find_or_enter(Vec3 p, Index fresh) {
    const auto found = numbers_.emplace(std::array<double, 3>{p.x, p.y, p.z}, fresh);
    return found.second ? kNoIndex : found.first->second;
  }

 private:
  std::map<std::array<double, 3>, Index> numbers_;
};

// Adds a decimated piece. `whole`: of its reference's triangles, the isosurface's numbers; `cell`: their
// cells along the axis.
void add_piece(const CertifiedState& state, const Cut& cut, Vec3 origin, const std::vector<Index>& whole,
               const std::vector<std::int32_t>& cell, CutPoints& cuts, Joined& joined) {
  const CertifiedMesh& mesh = state.mesh;
  const Vec3 by = origin - state.reference.points[0];
  std::vector<Index> number(mesh.points.size(), kNoIndex);
  for (Index v = 0; v < mesh.points.size(); ++v) {
    if (mesh.incident[v] == kNoIndex) continue;
    const Quadric quadric = moved_origin(state.quadrics[v], by);
    const Index fresh = static_cast<Index>(joined.points.size());
    const bool may_be_cut = mesh.is_on_contour(v) && mesh.is_locked[v];
    const Index known = may_be_cut ? cuts.find_or_enter(mesh.points[v], fresh) : kNoIndex;
    number[v] = known == kNoIndex ? fresh : known;
    if (known != kNoIndex) {
      joined.quadrics[known] += quadric;
      continue;
    }
    joined.points.push_back(mesh.points[v]);
    joined.nearest.push_back(whole[mesh.nearest[v]]);
    joined.quadrics.push_back(quadric);
    joined.blocked_by.push_back(state.blocked_by[v]);
  }
  std::vector<Index> triangle(mesh.triangles.size(), kNoIndex);
  for (Index t = 0; t < mesh.triangles.size(); ++t) {
    if (!mesh.triangles[t].is_alive()) continue;
    triangle[t] = static_cast<Index>(joined.triangles.size());
    const auto& c = mesh.triangles[t].corner;
    joined.triangles.push_back({number[c[0]], number[c[1]], number[c[2]]});
  }
  joined.uses.resize(joined.triangles.size(), 0);
  if (state.reverse_tolerance <= 0) return;
  for (Index s = 0; s < whole.size(); ++s) {
    BandProof entry{whole[s], state.proofs.proof[s]};
    if (entry.proof.home == kNoIndex) continue;
    ++joined.uses[entry.proof.home = triangle[entry.proof.home]];
    for (Index& label : entry.proof.label) {
      if (label != kNoIndex) ++joined.uses[label = triangle[label]];
    }
    for (std::size_t seam = 0; seam < cut.reach.size(); ++seam) {
      if (cut.is_in_band(seam, cell[s])) joined.bands[seam].push_back(entry);
    }
  }
}

// Triangles at locked vertices and their neighbours, about which nothing moves.
std::size_t frozen_triangles(const CertifiedMesh& mesh) {
  std::vector<std::uint8_t> is_frozen = mesh.is_locked;
  for (const LinkedTriangle& t : mesh.triangles) {
    if (!t.is_alive()) continue;
    const auto& c = t.corner;
    if (mesh.is_locked[c[0]] || mesh.is_locked[c[1]] || mesh.is_locked[c[2]])
      is_frozen[c[0]] = is_frozen[c[1]] = is_frozen[c[2]] = 1;
  }
  return static_cast<std::size_t>(
      std::count_if(mesh.triangles.begin(), mesh.triangles.end(), [&](const LinkedTriangle& t) {
        return t.is_alive() && (is_frozen[t.corner[0]] || is_frozen[t.corner[1]] || is_frozen[t.corner[2]]);
      }));
}

void decimate_piece(const Isosurface& isosurface, const Cut& cut, std::size_t part,
                    const std::vector<std::uint8_t>& is_small, DecimateOptions options,
                    const Context& context, CutPoints& cuts, Joined& joined) {
  std::vector<Index> order;
  std::optional<Reference> reference;
  {
    const Isosurface piece = cut_part(isosurface, cut.planes, part);
    if (piece.surface.triangles.empty()) return;
    reference.emplace(piece, &order);
  }
  const PartTriangles triangles = triangles_of_part(isosurface, cut.planes, part);
  PERIOST_ASSERT(triangles.number.size() == order.size());
  std::vector<Index> whole(order.size());
  std::vector<std::int32_t> cell(order.size());
  for (std::size_t t = 0; t < order.size(); ++t) {
    whole[t] = triangles.number[order[t]];
    cell[t] = triangles.cell[order[t]];
  }
  options.small_components = SmallComponents::kKeep;  // it is the whole that counts
  CertifiedState state = make_certified_state(*reference, isosurface, options, context);
  lock_cuts(cut, state);
  if (!is_small.empty()) drop_triangles(is_small, isosurface, whole, state);
  if (options.max_triangles > 0) {  // what is dense at the cuts is left to the bands
    const double share =
        static_cast<double>(order.size()) / static_cast<double>(isosurface.surface.triangles.size());
    options.max_triangles = static_cast<std::size_t>(share * static_cast<double>(options.max_triangles)) +
                            frozen_triangles(state.mesh) + 1;
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    joined.lo[axis] = std::max(joined.lo[axis], state.contours.lo[axis]);
    joined.hi[axis] = std::min(joined.hi[axis], state.contours.hi[axis]);
  }
  keep_between_cuts(cut.planes, part, state.contours);
  joined.counts += run_certified_schedule(state, options, context);
  add_piece(state, cut, isosurface.surface.points[0], whole, cell, cuts, joined);
}

// The output triangles that meet a slab, as a mesh; `point` and `triangle` are the whole's numbers.
struct BandMesh {
  CertifiedMesh mesh;
  std::vector<Index> point, triangle;
};
BandMesh gather_band(const Joined& joined, const GridFrame& frame, std::size_t axis, double lo, double hi) {
  BandMesh band;
  std::vector<Index> number(joined.points.size(), kNoIndex);
  for (Index t = 0; t < joined.triangles.size(); ++t) {
    const Triangle& c = joined.triangles[t];
    if (c[0] == kNoIndex) continue;
    const double a = frame.to_index(joined.points[c[0]])[axis], b = frame.to_index(joined.points[c[1]])[axis],
                 d = frame.to_index(joined.points[c[2]])[axis];
    if (std::max({a, b, d}) < lo || std::min({a, b, d}) > hi) continue;
    band.triangle.push_back(t);
    for (const Index v : c) number[v] = 0;
  }
  for (Index v = 0; v < number.size(); ++v) {
    if (number[v] == kNoIndex) continue;
    number[v] = static_cast<Index>(band.point.size());
    band.point.push_back(v);
    band.mesh.points.push_back(joined.points[v]);
  }
  for (const Index t : band.triangle) {
    const Triangle& c = joined.triangles[t];
    band.mesh.triangles.push_back({{number[c[0]], number[c[1]], number[c[2]]}, {}});
  }
  link_triangles(band.mesh.triangles, band.mesh.points.size());
  return band;
}

// Position in an ascending list, or kNoIndex.
Index position_in(const std::vector<Index>& list, Index value) {
  const auto found = std::lower_bound(list.begin(), list.end(), value);
  return found != list.end() && *found == value ? static_cast<Index>(found - list.begin()) : kNoIndex;
}

// Fills in the rest of the band's mesh. `uses`: of its triangles, the proofs of the band that name it.
void free_vertices(const Joined& joined, const GridFrame& frame, std::size_t axis, double lo, double hi,
                   const std::vector<std::uint32_t>& uses, BandMesh& band) {
  CertifiedMesh& mesh = band.mesh;
  const std::size_t count = mesh.points.size();
  mesh.incident.assign(count, kNoIndex);
  mesh.valence.assign(count, 0);
  mesh.version.assign(count, 1);
  mesh.is_locked.assign(count, 0);
  for (Index t = 0; t < mesh.triangles.size(); ++t) {
    const LinkedTriangle& triangle = mesh.triangles[t];
    for (std::size_t k = 0; k < 3; ++k) {
      const Index v = triangle.corner[k];
      if (mesh.incident[v] == kNoIndex) mesh.incident[v] = t;
      if (mesh.valence[v] < 255) ++mesh.valence[v];
      if (uses[t] != joined.uses[band.triangle[t]]) mesh.is_locked[v] = 1;
      if (triangle.across[k] != kNoIndex) continue;
      mesh.is_locked[triangle.corner[(k + 1) % 3]] = mesh.is_locked[triangle.corner[(k + 2) % 3]] = 1;
    }
  }
  for (Index v = 0; v < count; ++v) {
    const double q = frame.to_index(mesh.points[v])[axis];
    if (q <= lo || q >= hi || mesh.nearest[v] == kNoIndex) mesh.is_locked[v] = 1;
    if (mesh.nearest[v] == kNoIndex) mesh.nearest[v] = 0;  // locked vertices' are not looked at
  }
}

void write_back(const CertifiedState& state, const BandMesh& band, Joined& joined) {
  for (Index v = 0; v < band.point.size(); ++v) {
    joined.points[band.point[v]] = state.mesh.points[v];
    if (!state.mesh.is_locked[v]) joined.blocked_by[band.point[v]] = state.blocked_by[v];
  }
  for (Index t = 0; t < band.triangle.size(); ++t) {
    const auto& c = state.mesh.triangles[t].corner;
    Triangle& triangle = joined.triangles[band.triangle[t]];
    triangle[0] = kNoIndex;
    if (state.mesh.triangles[t].is_alive()) triangle = {band.point[c[0]], band.point[c[1]], band.point[c[2]]};
  }
}

std::size_t living_of(const Joined& joined) {
  return static_cast<std::size_t>(std::count_if(joined.triangles.begin(), joined.triangles.end(),
                                                [](const Triangle& t) { return t[0] != kNoIndex; }));
}

// The state of a band, its proofs in place.
void decimate_band(const Isosurface& isosurface, const Cut& cut, std::size_t seam, DecimateOptions options,
                   const Context& context, Joined& joined) {
  if (cut.reach[seam] < 2) return;
  const auto axis = static_cast<std::size_t>(cut.planes.axis);
  const CutPlanes slab{cut.planes.axis,
                       {cut.planes.at[seam] - cut.reach[seam], cut.planes.at[seam] + cut.reach[seam]}};
  const double lo = slab.at[0] + kInsideSlab, hi = slab.at[1] - kInsideSlab;
  BandMesh band = gather_band(joined, isosurface.frame, axis, lo, hi);
  std::vector<Index> order;
  std::optional<Reference> reference;
  {
    const Isosurface part = cut_part(isosurface, slab, 1);
    if (part.surface.triangles.empty()) return;
    reference.emplace(part, &order);
  }
  const std::vector<Index> whole = triangles_of_part(isosurface, slab, 1).number;
  std::vector<Index> in_reference(order.size());  // of the part's triangles
  for (Index r = 0; r < order.size(); ++r) in_reference[order[r]] = r;
  const auto reference_of = [&](Index iso) {
    const Index at = position_in(whole, iso);
    return at == kNoIndex ? kNoIndex : in_reference[at];
  };

  ReverseProofs proofs;
  proofs.proof.resize(order.size());
  proofs.next.assign(order.size(), kNoIndex);
  proofs.first.assign(band.triangle.size(), kNoIndex);
  proofs.first_labelled = proofs.first;
  std::vector<std::uint32_t> uses(band.triangle.size(), 0);
  for (const BandProof& entry : joined.bands[seam]) {
    // A home outside the band leaves its labels with a use that is not counted, so they stay.
    const Index s = reference_of(entry.iso), home = position_in(band.triangle, entry.proof.home);
    if (home == kNoIndex) continue;
    ++uses[home];
    ReverseProof proof;
    std::size_t count = 0;
    for (const Index label : entry.proof.label) {
      const Index at = label == kNoIndex ? kNoIndex : position_in(band.triangle, label);
      if (at == kNoIndex) continue;
      ++uses[at];
      proof.label[count++] = at;
    }
    proof.home = home;
    proofs.proof[s] = proof;
    Index& first = count > 0 ? proofs.first_labelled[home] : proofs.first[home];
    proofs.next[s] = first;
    first = s;
  }
  joined.bands[seam] = {};

  for (const Index v : band.point) band.mesh.nearest.push_back(reference_of(joined.nearest[v]));
  free_vertices(joined, isosurface.frame, axis, lo, hi, uses, band);

  options.small_components = SmallComponents::kKeep;
  if (options.max_triangles > 0) {
    const std::size_t living = living_of(joined), count = band.triangle.size();
    const std::size_t excess = living > options.max_triangles ? living - options.max_triangles : 0;
    options.max_triangles = std::max<std::size_t>(1, count - std::min(count, excess));
  }
  CertifiedState state = make_certified_state(*reference, isosurface, options, context);
  const Vec3 by = reference->points[0] - isosurface.surface.points[0];
  state.quadrics.clear();
  for (const Index v : band.point) state.quadrics.push_back(moved_origin(joined.quadrics[v], by));
  const double least_step = state.mesh.least_step;
  state.mesh = std::move(band.mesh);
  state.mesh.least_step = least_step;
  state.proofs = std::move(proofs);
  state.contours = {};
  state.contours.lo = joined.lo;
  state.contours.hi = joined.hi;
  state.contours.lo[axis] = std::max(joined.lo[axis], lo);
  state.contours.hi[axis] = std::min(joined.hi[axis], hi);
  state.sheets = SheetGrid(*reference, state.mesh, 2);
  state.failed.assign(3 * band.triangle.size(), 0);
  state.unmended.assign(band.triangle.size(), 0);
  state.settled.assign(band.point.size(), 0);
  state.blocked_by.assign(band.point.size(), 0);
  joined.counts += run_certified_schedule(state, options, context);
  write_back(state, band, joined);
}

SurfaceMesh surface_of(const Joined& joined, double voxel_mm) {
  SurfaceMesh surface;
  surface.voxel_mm = voxel_mm;
  std::vector<Index> number(joined.points.size(), kNoIndex);
  auto& blocked = surface.point_fields["blocked_by"];
  for (const Triangle& t : joined.triangles) {
    if (t[0] == kNoIndex) continue;
    for (const Index v : t) {
      if (number[v] != kNoIndex) continue;
      number[v] = static_cast<Index>(surface.points.size());
      surface.points.push_back(joined.points[v]);
      blocked.push_back(static_cast<float>(joined.blocked_by[v]));
    }
    surface.triangles.push_back({number[t[0]], number[t[1]], number[t[2]]});
  }
  return surface;
}

// Measured on a skull of 534,714 triangles: the program itself; per triangle of the isosurface, what is kept
// of pieces and for bands; per triangle of a piece, its working state.
constexpr double kProgramBytes = 21 * double{kMiB}, kKeptBytes = 60, kWorkingBytes = 320;
constexpr int kLeastPieceVoxels = 16;  // along the longest side of the image

double bytes_of(const Isosurface& isosurface) {
  return static_cast<double>(sizeof(Vec3) * isosurface.surface.points.size() +
                             sizeof(Triangle) * isosurface.surface.triangles.size() +
                             sizeof(CellBlock) * isosurface.blocks.size() +
                             sizeof(Index) * isosurface.block_table.size());
}

}  // namespace

std::uint32_t pieces_within(const Isosurface& isosurface, const Context& context) {
  if (context.memory_bytes == 0) return 1;
  const auto triangles = static_cast<double>(isosurface.surface.triangles.size());
  const auto& dims = isosurface.frame.dims;
  const double budget = static_cast<double>(context.memory_bytes);
  const double fixed = kProgramBytes + bytes_of(isosurface), working = kWorkingBytes * triangles;
  if (fixed + working <= budget) return 1;
  const double kept = fixed + kKeptBytes * triangles;
  const int most = std::max(2, *std::max_element(dims.begin(), dims.end()) / kLeastPieceVoxels);
  const double pieces = std::max(2.0, std::ceil(working / std::max(1.0, budget - kept)));
  if (pieces <= most) return static_cast<std::uint32_t>(pieces);
  throw Error(
      ErrorKind::kLimit, "limit.memory",
      fmt::format(
          "decimating {} triangles needs more than the {:.0f} MiB that --memory allows, even in {} pieces",
          isosurface.surface.triangles.size(), budget / static_cast<double>(kMiB), most),
      fmt::format("allow at least --memory {:.0f}MiB",
                  std::ceil((kept + working / most) / static_cast<double>(kMiB))));
}

SimplexMesh decimate_certified_in_pieces(const Isosurface& isosurface, std::uint32_t pieces,
                                         const DecimateOptions& options, Context& context) {
  const Cut cut = make_cut(isosurface, pieces);
  context.info("decimate.pieces", fmt::format("cut across axis {} at the voxels {}", "ijk"[cut.planes.axis],
                                              fmt::join(cut.planes.at, ", ")));
  std::vector<std::uint8_t> is_small;
  if (options.small_components == SmallComponents::kDrop && options.small_triangles > 0)
    is_small = small_components(isosurface, static_cast<std::size_t>(options.small_triangles));
  Joined joined;
  joined.bands.resize(cut.planes.at.size());
  {
    CutPoints cuts;
    for (std::size_t part = 0; part <= cut.planes.at.size(); ++part)
      decimate_piece(isosurface, cut, part, is_small, options, context, cuts, joined);
  }
  for (std::size_t seam = 0; seam < cut.planes.at.size(); ++seam)
    decimate_band(isosurface, cut, seam, options, context, joined);
  SimplexMesh mesh = finish_certified(surface_of(joined, isosurface.frame.largest_spacing()), joined.counts,
                                      isosurface, options, context);
  mesh.report.pieces = static_cast<std::uint32_t>(cut.planes.at.size() + 1);
  return mesh;
}

}  // namespace periost
