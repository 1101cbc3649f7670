#pragma once
// The moves of the certified scheme: T1^2 with the best place for the merged face's dual vertex, its inverse
// T2^2, T7^2, and the relocation of one dual vertex. Each passes every check before anything is changed.
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "stages/decimate/certificate_forward.h"
#include "stages/decimate/certificate_reverse.h"
#include "stages/decimate/certified_contours.h"
#include "stages/decimate/certified_guard.h"
#include "stages/decimate/certified_place.h"
#include "stages/decimate/certified_sheets.h"
#include "stages/decimate/certified_sizes.h"

namespace periost {

// Everything that moves read and change. Workers may run on it together as long as the rings they change,
// and what lies around these, are apart.
struct CertifiedState {
  const Reference& reference;
  CertifiedMesh mesh;
  ReverseProofs proofs;
  std::vector<Quadric> quadrics;  // of points
  SheetGrid sheets;
  SizeLimits sizes;
  double tolerance = 0;          // mm, rounding already taken off
  double reverse_tolerance = 0;  // mm, likewise; 0: no reverse certificate
  // Neighbourhoods in which a move was refused, by their signatures; it is not tried again in the same.
  std::vector<std::uint32_t> failed;     // removals, of half-edges
  std::vector<std::uint32_t> unmended;   // of triangles
  std::vector<std::uint32_t> settled;    // relocations, of points
  std::vector<std::uint8_t> blocked_by;  // of points: the last Refusal there
  CertifiedContours contours;
  double share = 1;  // of the whole isosurface's triangles, that this is about
};

struct MoveCounts {
  std::uint64_t removals = 0, insertions = 0, swaps = 0, relocations = 0;
  std::array<std::uint64_t, static_cast<std::size_t>(Refusal::kCount)> refused{};

  std::uint64_t moves() const { return removals + insertions + swaps + relocations; }
  MoveCounts& operator+=(const MoveCounts& other);
};

// What one thread needs besides.
struct Worker {
  GuardLimits limits;
  std::size_t quota = std::numeric_limits<std::size_t>::max();  // removals that passes may still make
  // Removals are tried at several heights, and edges around them swapped at once where D asks for it.
  bool is_thorough = true;
  Proposal proposal;
  RingScratch ring;
  ForwardScratch forward;
  ReverseScratch reverse;
  SheetScratch sheets;
  std::vector<Index> around;
  std::vector<Index> dead_points, dead_triangles;  // that insertions may bring to life
  MoveCounts counts;
  // Dual vertices may not leave this box of the image's index space: the region of a parallel pass.
  Vec3 region_lo{-1e300, -1e300, -1e300}, region_hi{1e300, 1e300, 1e300};
};

// Contracts the dual edge of triangle `t` opposite to corner `k`. True when it was applied; the merged vertex
// is then worker.proposal.moved.
bool try_removal(CertifiedState& state, Worker& worker, Index t, std::size_t k);

// The same for an edge of a triangle with a bad angle: the ends, the middle and the rim's centroid are tried
// as places too, and the sum of angle deficits must fall.
bool try_mending_removal(CertifiedState& state, Worker& worker, Index t, std::size_t k);

// Flips that edge. With `improve_angles` the sum of angle deficits must fall; otherwise the criterion is
// D > 2, so that the sum of (valence - 6)^2 falls.
bool try_swap(CertifiedState& state, Worker& worker, Index t, std::size_t k, bool improve_angles);

// Moves a dual vertex to `place` (mm). With `improve_angles` the sum of angle deficits must fall.
bool try_relocation(CertifiedState& state, Worker& worker, Index vertex, Vec3 place, bool improve_angles);

// Inserts a dual vertex on that edge, at its middle or a little off it; the sum of angle deficits must fall.
// Takes its ids from worker.dead_*; false when there are none.
bool try_insertion(CertifiedState& state, Worker& worker, Index t, std::size_t k);

// Which certificate is asked first: the overlay of the ring, or each triangle's own. Of moves tried to mend
// angles most are refused, and what is refused triangle by triangle is so sooner.
enum class FirstAsked { kRing, kTriangles };

// Steps that moves share. `check_move`: all criteria but link and angles on worker.proposal, whose sum of
// angle deficits falls by `gain`; `facing`: a direction that the isosurface at the place faces. `commit_move`
// applies what it accepted. `refuse_move` counts a refusal at a vertex and returns false.
Refusal check_move(CertifiedState& state, Worker& worker, Vec3 facing, double gain, FirstAsked asked);
void commit_move(CertifiedState& state, Worker& worker);
// Likewise an insertion on the edge (u, v): with a quadric of its own, its ids no longer the worker's.
void commit_insertion(CertifiedState& state, Worker& worker, Index u, Index v);
bool refuse_move(CertifiedState& state, Worker& worker, Refusal refusal, Index vertex);
// Smaller falls of the sum of angle deficits do not count.
double least_angle_gain(const GuardLimits& limits);

// The mean isosurface normal at the ends of an edge, unit length.
Vec3 edge_normal(const CertifiedState& state, Index u, Index v);
// Sum of the versions of all vertices that a proposed removal concerns: unchanged only if none has changed.
std::uint32_t removal_signature(const CertifiedMesh& mesh, const Proposal& proposal);
// Where state.failed keeps the edge of triangle t opposite to corner k, from whichever side it is seen.
std::size_t removal_slot(const CertifiedMesh& mesh, Index t, std::size_t k);

// D of the edge of triangle t opposite to corner k. Precondition: not on a contour.
int topological_difference(const CertifiedMesh& mesh, Index t, std::size_t k);

// The cost of contracting an edge: the quadric at the best place, plus a little of the length so that flat
// regions thin out evenly.
double removal_cost(const CertifiedState& state, Index u, Index v);

}  // namespace periost
