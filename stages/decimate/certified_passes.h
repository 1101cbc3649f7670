#pragma once
// The passes of the certified scheme over a range of dual vertices. Vertices are numbered along a Morton
// curve, so a range is a compact patch whose queue and geometry stay in the cache.
#include <utility>
#include <vector>

#include "stages/decimate/certified_moves.h"

namespace periost {

// Vertices first .. last - 1.
using VertexRange = std::pair<Index, Index>;

// Cuts the vertices into consecutive ranges with about `alive` living vertices each.
std::vector<VertexRange> vertex_ranges(const CertifiedMesh& mesh, std::size_t alive);

// Median removal cost over a sample of the edges. Deterministic.
double median_removal_cost(const CertifiedState& state);

// Tries to remove the edges of a range that cost at most `limit`, cheapest first, with swaps around each
// removal. An edge belongs to the range that holds its smaller vertex.
void removal_pass(CertifiedState& state, Worker& worker, VertexRange range, double limit);

// Swaps edges with D > 2.
void swap_pass(CertifiedState& state, Worker& worker, VertexRange range);

// Moves vertices towards the minimum of their own quadric and the middle of their neighbours.
void relocation_pass(CertifiedState& state, Worker& worker, VertexRange range);

// Mends triangles with an angle under the limit by swaps, removals and moves that make the sum of deficits
// fall.
void angle_pass(CertifiedState& state, Worker& worker, VertexRange range);

// Raises the worst angles: triangles far under the limit are mended by the same moves and by moving their
// corners and the neighbours of these in many directions. To be run with limits.worst_angle_first.
void sliver_pass(CertifiedState& state, Worker& worker, VertexRange range);

// Moves vertices along the normal by half the mean signed height of the isosurface over their triangles, so
// that the enclosed volume is kept. Does nothing without the reverse certificate, whose homes it reads.
void fit_pass(CertifiedState& state, Worker& worker, VertexRange range);

}  // namespace periost
