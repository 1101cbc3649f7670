#pragma once
// The certified scheme of decimation: the simplex mesh, operators and criteria of the paper, with the
// distance between the output triangulation and the isosurface proved in both directions.
//
// Every simplex face stores its dual vertex, a vertex of the output triangulation. They start at the vertices
// of marching cubes, where the output is the isosurface itself and both distances are 0. Every move (an edge
// removal T1^2 with the best place for the merged face's dual vertex, its inverse T2^2, a swap T7^2, the
// relocation of one dual vertex) replaces the triangles of one ring, and passes every check before anything
// is changed:
//   link condition, no new neck of three edges, valences 3..9, topological criterion, angles of the dual
//   triangles, barycentric coordinates, fold and dihedral angles (certified_guard.h); forward and reverse
//   certificate; no intersection with what stays (certified_sheets.h).
//
// Why the two-sided distance holds. Invariant F: each output triangle lies within the tolerance of the
// isosurface. It holds at the start; a move brings in only triangles that the forward certificate proves
// (certificate_forward.h) and leaves the others as they are. Invariant R: each isosurface triangle lies
// within the tolerance of the union of its home and labels. It holds at the start, each triangle being its
// own home; a proof is hurt only by a move that changes its home or a label, such a move renews it or is
// refused (certificate_reverse.h). By induction both hold at the end: the Hausdorff distance between output
// and isosurface is at most the tolerance. Coordinates are double and 1e-4 of the tolerance is kept for
// rounding. With `reverse: none` only F is kept; with 2, R holds for twice the tolerance.
//
// Why the topology stays. Removals meet the link condition and swaps never double an edge, so each component
// stays a manifold of the same Euler number. Self-intersections are kept out move by move with exact
// predicates wherever sheets of the isosurface are close to one another (certified_sheets.h), and looked for
// everywhere at the end; should there be one, all is done again with every place watched.
//
// Schedule. Swaps; removals by cost in stages, each up to the median cost of the edges left; final rounds of
// removals of any cost, the first of them down to 0.87 or 0.77 of the least angle, relocations (along the
// surface to the quadric's place, along the normal by half the mean signed height of the isosurface), and
// mending of angles under 1.3 times the least one, which makes room for the next round; the law of motion
// (certified_deform.h), `iterations` steps, each vertex as far as the checks allow; angles; fits along the
// normal until the surface encloses what the isosurface does, or nearly; angles again; and slivers one by
// one, the worst with all around them (certified_rescue.h). Space is cut by the data into regions that are
// worked on at the same time (certified_regions.h).
//
// What is aimed for rather than guaranteed. Angles under the limit, which marching cubes makes in numbers,
// may stay where nothing better was found: their sum of deficits never grows. Moves that make it fall may
// pass by the topological and barycentric criteria. |D| may exceed T by 3 while edges are removed; swaps
// bring it down at the end where the other criteria allow.
//
// Contours of an open isosurface are decimated within the same tolerance. Invariant C: the isosurface's
// contour is shared out between the output's contour edges, each of which lies within the tolerance of its
// share in the sense of Frechet; it holds at the start, and a move that changes contour edges proves it for
// the new ones (certified_contours.h). So contours do not recede or stray by more than the tolerance, on
// either side. What lies on a border plane of the image stays on it, what lies on two stays where it is, and
// inner vertices do not come to these planes. F and R are as before, near contours too: an overlay that meets
// a contour proves nothing, and bisection decides. Every removal at a contour meets the link condition there
// (certified_contour_moves.h), so contours keep their number.
#include "pipeline/base/context.h"
#include "pipeline/data/isosurface.h"
#include "pipeline/data/simplex_mesh.h"
#include "stages/decimate/decimate.h"

namespace periost {

// Decimates until no move is possible. face_fields: "blocked_by", the number of the criterion that refused
// the last removal at that vertex (0 none, 1 link, 2 topology, 3 barycentric, 4 angle, 5 fold, 6 distance,
// 7 reverse, 8 self-intersection). Deterministic, whatever context.threads.
// Precondition: marching_cubes' guarantees on `isosurface`. Throws Error{kQuality,
// "decimate.self_intersection"} if the result intersects itself though the isosurface does not; {kUsage,
// "decimate.no_voxel"}; {kInterrupted}. Some 400 bytes an isosurface triangle.
SimplexMesh decimate_certified(const Isosurface& isosurface, const DecimateOptions& options,
                               Context& context);

}  // namespace periost
