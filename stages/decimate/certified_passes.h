#pragma once
// The passes of the certified scheme over a list of dual vertices, ascending. Vertices are numbered along a
// Morton curve, so neighbours in the list are neighbours in space. Dead and locked ones are skipped.
#include <vector>

#include "stages/decimate/certified_moves.h"

namespace periost {

using VertexList = std::vector<Index>;

// Median removal cost over a sample of the edges. Deterministic.
double median_removal_cost(const CertifiedState& state, const Context& context);

// Tries to remove the edges that cost at most `limit`, cheapest first within runs of a thousand vertices,
// with swaps around each removal; ends when worker.quota is used up. An edge belongs to the run that holds
// its smaller vertex.
void removal_pass(CertifiedState& state, Worker& worker, const VertexList& vertices, double limit);

// Swaps edges with D > 2.
void swap_pass(CertifiedState& state, Worker& worker, const VertexList& vertices);

// Moves vertices along the surface, towards the minimum of their own quadric and the middle of their
// neighbours, and along the normal as fit_pass does. Both at once: apart they would undo one another.
void relocation_pass(CertifiedState& state, Worker& worker, const VertexList& vertices);

// Moves vertices along the normal by `mean`, the mean signed height of the isosurface over the whole surface,
// and by half of what the mean height over their own triangles differs from it, so that the enclosed volume
// is kept; those that would move against the mean stay. Does nothing without the reverse certificate, whose
// homes it reads.
void fit_pass(CertifiedState& state, Worker& worker, const VertexList& vertices, double mean);

// Mends triangles with an angle under `aim` (radians) by swaps, removals and moves that make the sum of
// deficits to it fall. An aim above the limit makes room for further removals.
void angle_pass(CertifiedState& state, Worker& worker, const VertexList& vertices, double aim);

// What mending slivers may do, the worst first.
GuardLimits mending_slivers(GuardLimits limits);

// The corners of the triangles with an angle under `limit` (radians), ascending.
VertexList sliver_vertices(const CertifiedState& state, double limit);
// Likewise, of the triangles at free vertices among those given and next to them: where moves about those may
// have left some. Reads nothing but the stars of free vertices.
VertexList sliver_vertices_near(const CertifiedState& state, double limit, const VertexList& vertices);

// Raises the worst angles: triangles far under the limit are mended by the same moves and by moving their
// corners and the neighbours of these in many directions, and by insertions where the worker has ids for
// them; deficits count by their fourth power. What failed without insertions is tried with them only.
void sliver_pass(CertifiedState& state, Worker& worker, const VertexList& vertices);

// Splits triangles with an angle under `limit`, radians, though the sum of deficits grows a little: thin bars
// of long triangles cannot be mended one move at a time, but once split they can. Needs worker.dead_*.
void split_pass(CertifiedState& state, Worker& worker, const VertexList& vertices, double limit);

}  // namespace periost
