#include "stages/decimate/certified_bands.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "stages/decimate/certified_pieces.h"
#include "stages/decimate/certified_schedule.h"

namespace periost {
namespace {

constexpr double kInsideSlab = 1e-3;  // voxels that free vertices keep from a slab's planes

// Position in an ascending list, or kNoIndex.
Index position_in(const std::vector<Index>& list, Index value) {
  const auto found = std::lower_bound(list.begin(), list.end(), value);
  return found != list.end() && *found == value ? static_cast<Index>(found - list.begin()) : kNoIndex;
}

// The slab's planes in the image's index space, a little inwards; far away where it has none.
struct Bounds {
  std::size_t axis;
  double lo, hi;

  bool holds(double q) const { return q > lo && q < hi; }
};
Bounds bounds_of(const GridFrame& frame, int axis, Slab slab) {
  constexpr double kFar = 1e300;
  const auto a = static_cast<std::size_t>(axis);
  return {a, slab.first > -1 ? slab.first + kInsideSlab : -kFar,
          slab.last < frame.dims[a] ? slab.last - kInsideSlab : kFar};
}

// The isosurface in a slab.
struct SlabReference {
  std::optional<Reference> reference;  // none when the slab is empty
  std::vector<Index> whole;            // of the reference's triangles: the isosurface's numbers
  std::vector<Index> numbers;          // the isosurface's numbers, ascending..
  std::vector<Index> in_reference;     // ..and where these triangles stand in the reference

  Index position_of(Index isosurface_triangle) const {
    const Index at = position_in(numbers, isosurface_triangle);
    return at == kNoIndex ? kNoIndex : in_reference[at];
  }
};
SlabReference reference_of(const Isosurface& isosurface, int axis, Slab slab) {
  SlabReference part;
  std::vector<Index> order;
  {
    const Isosurface cut = cut_slab(isosurface, axis, slab);
    if (cut.surface.triangles.empty()) return part;
    part.reference.emplace(cut, &order);
  }
  part.numbers = triangles_of_slab(isosurface, axis, slab);
  part.whole.resize(order.size());
  part.in_reference.resize(order.size());
  for (Index r = 0; r < order.size(); ++r) {
    part.whole[r] = part.numbers[order[r]];
    part.in_reference[order[r]] = r;
  }
  return part;
}

// The output triangles that meet a slab, as a mesh; `point` and `triangle` are the whole's numbers.
struct BandMesh {
  CertifiedMesh mesh;
  std::vector<Index> point, triangle;
  std::vector<std::uint8_t> is_inside;  // of points: between the planes
  std::vector<std::uint8_t> is_locked;  // of points, before decimation
};
BandMesh gather_band(const JoinedMesh& joined, const GridFrame& frame, const Bounds& bounds) {
  BandMesh band;
  std::vector<double> place(joined.points.size());
  for (Index v = 0; v < place.size(); ++v) place[v] = frame.to_index(joined.points[v])[bounds.axis];
  std::vector<Index> number(joined.points.size(), kNoIndex);
  for (Index t = 0; t < joined.triangles.size(); ++t) {
    const Triangle& c = joined.triangles[t];
    if (c[0] == kNoIndex) continue;
    const double a = place[c[0]], b = place[c[1]], d = place[c[2]];
    if (std::max({a, b, d}) < bounds.lo || std::min({a, b, d}) > bounds.hi) continue;
    band.triangle.push_back(t);
    for (const Index v : c) number[v] = 0;
  }
  for (Index v = 0; v < number.size(); ++v) {
    if (number[v] == kNoIndex) continue;
    number[v] = static_cast<Index>(band.point.size());
    band.point.push_back(v);
    band.mesh.points.push_back(joined.points[v]);
    band.is_inside.push_back(bounds.holds(place[v]) ? 1 : 0);
  }
  for (const Index t : band.triangle) {
    const Triangle& c = joined.triangles[t];
    band.mesh.triangles.push_back({{number[c[0]], number[c[1]], number[c[2]]}, {}});
  }
  link_triangles(band.mesh.triangles, band.mesh.points.size());
  return band;
}

// The proofs of the slab's isosurface triangles as they are for the band's mesh.
struct BandProofs {
  ReverseProofs proofs;
  std::vector<std::uint32_t> uses;  // of the band's triangles
};
// Home and labels by the band's numbers; those outside of the band, which do not change, are left out.
ReverseProof proof_in_band(const ReverseProof& whole, const BandMesh& band) {
  ReverseProof proof;
  proof.home = position_in(band.triangle, whole.home);
  if (proof.home == kNoIndex) return proof;
  std::size_t count = 0;
  for (const Index label : whole.label) {
    const Index at = label == kNoIndex ? kNoIndex : position_in(band.triangle, label);
    if (at != kNoIndex) proof.label[count++] = at;
  }
  return proof;
}
BandProofs proofs_in_band(const JoinedMesh& joined, const SlabReference& part, const BandMesh& band) {
  BandProofs found;
  ReverseProofs& proofs = found.proofs;
  proofs.proof.resize(part.whole.size());
  proofs.next.assign(part.whole.size(), kNoIndex);
  proofs.first.assign(band.triangle.size(), kNoIndex);
  proofs.first_labelled = proofs.first;
  found.uses.assign(band.triangle.size(), 0);
  for (Index s = 0; s < part.whole.size() && !joined.proofs.empty(); ++s) {
    // A home outside of the band leaves its labels with a use that is not counted, so they stay.
    const ReverseProof proof = proof_in_band(joined.proofs[part.whole[s]], band);
    if (proof.home == kNoIndex) continue;
    ++found.uses[proof.home];
    for (const Index label : proof.label) {
      if (label != kNoIndex) ++found.uses[label];
    }
    proofs.proof[s] = proof;
    Index& first = proof.label[0] != kNoIndex ? proofs.first_labelled[proof.home] : proofs.first[proof.home];
    proofs.next[s] = first;
    first = s;
  }
  return found;
}

// Locks vertices that are not between the planes, at the rim of the band, or without isosurface beside them;
// and one corner of each triangle that proofs outside of the slab name, which keeps the triangle. A triangle
// with a locked corner is kept anyway, whatever names it.
void lock_band(const JoinedMesh& joined, const std::vector<std::uint32_t>& uses,
               const std::vector<std::uint32_t>& uses_in_slab, BandMesh& band) {
  CertifiedMesh& mesh = band.mesh;
  for (Index v = 0; v < mesh.points.size(); ++v) {
    if (band.is_inside[v] == 0 || mesh.nearest[v] == kNoIndex) mesh.is_locked[v] = 1;
    if (mesh.nearest[v] == kNoIndex) mesh.nearest[v] = 0;  // locked vertices' are not looked at
  }
  for (const LinkedTriangle& triangle : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (triangle.across[k] != kNoIndex) continue;
      mesh.is_locked[triangle.corner[(k + 1) % 3]] = mesh.is_locked[triangle.corner[(k + 2) % 3]] = 1;
    }
  }
  if (joined.proofs.empty()) return;
  for (Index t = 0; t < mesh.triangles.size(); ++t) {
    const auto& c = mesh.triangles[t].corner;
    if (mesh.is_locked[c[0]] || mesh.is_locked[c[1]] || mesh.is_locked[c[2]]) continue;
    if (uses_in_slab[t] != uses[band.triangle[t]]) mesh.is_locked[c[0]] = 1;
  }
}

// Fills in what follows from the band's triangles.
void complete_mesh(CertifiedMesh& mesh) {
  const std::size_t count = mesh.points.size();
  mesh.incident.assign(count, kNoIndex);
  mesh.valence.assign(count, 0);
  mesh.version.assign(count, 1);
  mesh.is_locked.assign(count, 0);
  for (Index t = 0; t < mesh.triangles.size(); ++t) {
    for (const Index v : mesh.triangles[t].corner) {
      if (mesh.incident[v] == kNoIndex) mesh.incident[v] = t;
      if (mesh.valence[v] < 255) ++mesh.valence[v];
    }
  }
}

void write_proofs(const CertifiedState& state, const SlabReference& part, const BandMesh& band,
                  JoinedMesh& joined) {
  for (Index s = 0; s < part.whole.size() && !joined.proofs.empty(); ++s) {
    ReverseProof proof = state.proofs.proof[s];
    if (proof.home == kNoIndex) continue;
    ReverseProof& known = joined.proofs[part.whole[s]];
    const ReverseProof before = proof_in_band(known, band);
    // What has not been renewed may have labels outside of the band.
    if (before.home == proof.home && before.label == proof.label) continue;
    known.home = band.triangle[proof.home];
    for (std::size_t k = 0; k < 3; ++k)
      known.label[k] = proof.label[k] == kNoIndex ? kNoIndex : band.triangle[proof.label[k]];
  }
}

void write_back(const CertifiedState& state, const SlabReference& part, Vec3 origin, const BandMesh& band,
                JoinedMesh& joined) {
  const Vec3 by = origin - state.reference.points[0];
  for (Index v = 0; v < band.point.size(); ++v) {
    if (band.is_locked[v]) continue;
    const Index p = band.point[v];
    joined.points[p] = state.mesh.points[v];
    joined.nearest[p] = part.whole[state.mesh.nearest[v]];
    joined.quadrics[p] = moved_origin(state.quadrics[v], by);
    joined.blocked_by[p] = state.blocked_by[v];
  }
  for (Index t = 0; t < band.triangle.size(); ++t) {
    const auto& c = state.mesh.triangles[t].corner;
    Triangle& triangle = joined.triangles[band.triangle[t]];
    triangle[0] = kNoIndex;
    if (state.mesh.triangles[t].is_alive()) triangle = {band.point[c[0]], band.point[c[1]], band.point[c[2]]};
  }
  write_proofs(state, part, band, joined);
}

// Of slabs: the living triangles whose first corner lies between their planes.
std::vector<std::size_t> count_triangles(const JoinedMesh& joined, const GridFrame& frame, int axis,
                                         const std::vector<Slab>& slabs, std::size_t& living) {
  std::vector<std::size_t> count(slabs.size(), 0);
  living = 0;
  for (const Triangle& t : joined.triangles) {
    if (t[0] == kNoIndex) continue;
    ++living;
    const double q = frame.to_index(joined.points[t[0]])[static_cast<std::size_t>(axis)];
    for (std::size_t s = 0; s < slabs.size(); ++s)
      count[s] += q > slabs[s].first && q <= slabs[s].last ? 1 : 0;
  }
  return count;
}

}  // namespace

void decimate_slab(const Isosurface& isosurface, int axis, Slab slab, const std::vector<std::uint32_t>& uses,
                   std::size_t removable, DecimateOptions options, const Context& context,
                   JoinedMesh& joined) {
  const Bounds bounds = bounds_of(isosurface.frame, axis, slab);
  const SlabReference part = reference_of(isosurface, axis, slab);
  if (!part.reference) return;
  const Reference& reference = *part.reference;
  BandMesh band = gather_band(joined, isosurface.frame, bounds);
  for (const Index v : band.point) band.mesh.nearest.push_back(part.position_of(joined.nearest[v]));
  BandProofs found = proofs_in_band(joined, part, band);
  complete_mesh(band.mesh);
  lock_band(joined, uses, found.uses, band);

  StateParts parts{std::move(band.mesh), std::move(found.proofs), {}, {}};
  band.is_locked = parts.mesh.is_locked;
  const Vec3 origin = isosurface.surface.points[0];
  for (const Index v : band.point)
    parts.quadrics.push_back(moved_origin(joined.quadrics[v], reference.points[0] - origin));
  parts.contours.lo = joined.lo;
  parts.contours.hi = joined.hi;
  parts.contours.lo[bounds.axis] = std::max(joined.lo[bounds.axis], bounds.lo);
  parts.contours.hi[bounds.axis] = std::min(joined.hi[bounds.axis], bounds.hi);
  if (options.max_triangles > 0) {
    const std::size_t count = band.triangle.size();
    options.max_triangles = std::max<std::size_t>(1, count - std::min(count, removable));
  }
  CertifiedState state = assemble_state(reference, isosurface, std::move(parts), options, context);
  joined.counts += run_certified_schedule(state, options, Extent::kToTheEnd, context);
  write_back(state, part, origin, band, joined);
}

void decimate_slabs(const Isosurface& isosurface, int axis, const std::vector<Slab>& slabs,
                    const std::vector<std::size_t>& order, const DecimateOptions& options,
                    const Context& context, JoinedMesh& joined) {
  const std::vector<std::uint32_t> uses = count_uses(joined);
  std::vector<std::size_t> removable(slabs.size(), 0);
  if (options.max_triangles > 0) {
    std::size_t living = 0, in_slabs = 0;
    const auto count = count_triangles(joined, isosurface.frame, axis, slabs, living);
    for (const std::size_t c : count) in_slabs += c;
    const std::size_t excess = living - std::min(living, options.max_triangles);
    for (std::size_t s = 0; s < slabs.size() && in_slabs > 0; ++s)
      removable[s] = (excess * count[s] + in_slabs - 1) / in_slabs;
  }
  for (const std::size_t s : order)
    decimate_slab(isosurface, axis, slabs[s], uses, removable[s], options, context, joined);
}

}  // namespace periost
