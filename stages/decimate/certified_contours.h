#pragma once
// Contours of an open isosurface in the certified scheme: closed polylines that the output's contours follow,
// each point of a border plane of the image staying on it.
//
// The contour certificate. Every contour vertex of the output has a station on the isosurface's contour; the
// stations along one contour are in order, so its edges share the isosurface's contour out between them: each
// has the arc between the stations of its ends. Invariant C: an edge lies within the tolerance of its arc in
// the sense of Frechet, that is, one can walk along both from end to end, never backwards, and never be
// further apart than the tolerance. It holds at the start, where every edge is its own arc; a move that
// changes contour edges is refused unless it holds for the new ones. So at the end both contours lie within
// the tolerance of each other, each altogether, and run along each other. Walk: the corners of the arc take
// places on the edge in order, each within the tolerance; between two of them both walks are straight, and
// the distance between two points that move evenly is convex.
#include "stages/decimate/certified_mesh.h"
#include "stages/decimate/certified_place.h"

namespace periost {

// A place along a contour: point floor(at) of its loop and the part of the way to the next.
struct ContourStation {
  Index loop = kNoIndex;
  double at = 0;
  std::uint8_t planes = 0;  // bits 2 a and 2 a + 1: on the border plane of axis a, index 0 and dims - 1
};

struct CertifiedContours {
  std::vector<std::vector<Vec3>> loops;  // of the isosurface, mm; the surface is on the left
  std::vector<Index> slot;               // of points: position in `stations`, kNoIndex off contours
  std::vector<ContourStation> stations;
  // Bounds in the image's index space: of inner vertices, by border planes with contours; and of vertices on
  // contours, by cuts where the isosurface is a piece.
  Vec3 lo{-1e300, -1e300, -1e300}, hi{1e300, 1e300, 1e300}, cut_lo = lo, cut_hi = hi;

  bool empty() const { return loops.empty(); }
  const ContourStation& of(Index v) const { return stations[slot[v]]; }
  ContourStation& of(Index v) { return stations[slot[v]]; }
};

// The contours of a mesh that is still the isosurface. Pins points on two border planes and where a contour
// leaves a plane; locks contours that touch others. A point is on a plane within a millionth of a voxel.
CertifiedContours make_contours(const Reference& reference, CertifiedMesh& mesh);

// Adds to the quadrics of contour points the squared distances to the lines of their contour edges.
void add_contour_quadrics(const Reference& reference, const CertifiedMesh& mesh,
                          std::vector<Quadric>& quadrics);

// The point at a station.
Vec3 contour_point(const CertifiedContours& contours, Index loop, double at);

// The part of the way from `from` on along a loop to `to`, in points; in [0, size).
double contour_way(const CertifiedContours& contours, Index loop, double from, double to);

// The station nearest to p among those from `from` on up to `to`. O(arc).
double nearest_station(const CertifiedContours& contours, Index loop, double from, double to, Vec3 p);

// Whether the edge p q lies within the tolerance of the arc, in the sense above. Exact up to rounding;
// O(arc).
bool follows_contour(const CertifiedContours& contours, Index loop, double from, double to, Vec3 p, Vec3 q,
                     double tolerance);

// p moved onto the border planes named.
Vec3 onto_planes(const GridFrame& frame, std::uint8_t planes, Vec3 p);

// Unit vector across a contour that runs `along`: within its border plane where it has one, else at right
// angles to the surface's `normal`.
Vec3 across_contour(const GridFrame& frame, std::uint8_t planes, Vec3 along, Vec3 normal);

// Neighbours along the contour. Precondition: on a contour, alive.
Index contour_next(const CertifiedMesh& mesh, Index v);
Index contour_previous(const CertifiedMesh& mesh, Index v);

}  // namespace periost
