#include "stages/decimate/certified_contours.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace periost {
namespace {

constexpr double kOnPlane = 1e-6;      // voxels
constexpr double kContourWeight = 1;   // of contour quadrics beside those of the surface
constexpr double kPlaneMargin = 1e-3;  // voxels that inner vertices keep from a border plane with contours

std::uint8_t planes_at(const GridFrame& frame, Vec3 p) {
  const Vec3 q = frame.to_index(p);
  std::uint8_t planes = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (frame.dims[axis] < 2) continue;
    if (std::abs(q[axis]) < kOnPlane) planes |= static_cast<std::uint8_t>(1u << (2 * axis));
    if (std::abs(q[axis] - (frame.dims[axis] - 1)) < kOnPlane)
      planes |= static_cast<std::uint8_t>(1u << (2 * axis + 1));
  }
  return planes;
}

// The points of the contour from `start` on; false when it runs into itself before it comes back.
bool walk_contour(const CertifiedMesh& mesh, Index start, std::vector<std::uint8_t>& seen,
                  std::vector<Index>& loop) {
  loop.clear();
  bool is_simple = true;
  Index v = start;
  do {
    seen[v] = 1;
    is_simple = is_simple && mesh.is_locked[v] == 0;
    loop.push_back(v);
    v = contour_next(mesh, v);
  } while (seen[v] == 0);
  return is_simple && v == start && loop.size() > 2;
}

// Planes of both edges at a point, and whether it stays where it is.
void classify(CertifiedContours& contours, const std::vector<Index>& loop,
              const std::vector<std::uint8_t>& planes, CertifiedMesh& mesh) {
  const std::size_t count = loop.size();
  for (std::size_t i = 0; i < count; ++i) {
    const unsigned here = planes[i];
    const unsigned before = here & planes[(i + count - 1) % count], after = here & planes[(i + 1) % count];
    contours.of(loop[i]).planes = planes[i];
    if (std::popcount(here) > 1 || before != after || before != here) mesh.contour[loop[i]] = kPinned;
  }
}

void bound(CertifiedContours& contours, const GridFrame& frame) {
  unsigned used = 0;
  for (const ContourStation& station : contours.stations) used |= station.planes;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (used & 1u << (2 * axis)) contours.lo[axis] = kPlaneMargin;
    if (used & 1u << (2 * axis + 1)) contours.hi[axis] = frame.dims[axis] - 1 - kPlaneMargin;
  }
}

// The part of the segment p q within the tolerance of w, as parameters; false when there is none.
bool near_part(Vec3 p, Vec3 q, Vec3 w, double tolerance, double& first, double& last) {
  const Vec3 d = q - p;
  const double length2 = squared_norm(d);
  if (!(length2 > 0)) {
    first = 0;
    last = 1;
    return squared_norm(w - p) <= tolerance * tolerance;
  }
  const double along = dot(w - p, d) / length2;
  const double off2 = squared_norm(w - p - d * along);
  if (off2 > tolerance * tolerance) return false;
  const double half = std::sqrt((tolerance * tolerance - off2) / length2);
  first = std::max(0.0, along - half);
  last = std::min(1.0, along + half);
  return first <= last;
}

}  // namespace

Index contour_next(const CertifiedMesh& mesh, Index v) {
  const LinkedTriangle& first = mesh.triangles[mesh.incident[v]];
  return first.corner[(first.slot_of(v) + 1) % 3];
}

Index contour_previous(const CertifiedMesh& mesh, Index v) {
  for (Index t = mesh.incident[v];;) {
    const LinkedTriangle& triangle = mesh.triangles[t];
    const std::size_t k = triangle.slot_of(v);
    t = triangle.across[(k + 1) % 3];
    if (t == kNoIndex) return triangle.corner[(k + 2) % 3];
  }
}

CertifiedContours make_contours(const Reference& reference, CertifiedMesh& mesh) {
  CertifiedContours contours;
  if (mesh.contour.empty()) return contours;
  contours.slot.assign(mesh.points.size(), kNoIndex);
  std::vector<std::uint8_t> seen(mesh.points.size(), 0), planes;
  std::vector<Index> loop;
  for (Index start = 0; start < mesh.points.size(); ++start) {
    if (!mesh.is_on_contour(start) || mesh.incident[start] == kNoIndex || seen[start]) continue;
    if (!walk_contour(mesh, start, seen, loop)) {
      for (const Index v : loop) mesh.is_locked[v] = 1;
      continue;
    }
    auto& points = contours.loops.emplace_back();
    planes.clear();
    for (const Index v : loop) {
      planes.push_back(planes_at(reference.frame(), mesh.points[v]));
      contours.slot[v] = static_cast<Index>(contours.stations.size());
      contours.stations.push_back(
          {static_cast<Index>(contours.loops.size() - 1), static_cast<double>(points.size()), planes.back()});
      points.push_back(mesh.points[v]);
    }
    classify(contours, loop, planes, mesh);
  }
  bound(contours, reference.frame());
  return contours;
}

void add_contour_quadrics(const Reference& reference, const CertifiedMesh& mesh,
                          std::vector<Quadric>& quadrics) {
  if (mesh.contour.empty()) return;
  for (Index t = 0; t < reference.triangles.size(); ++t) {
    const LinkedTriangle& triangle = reference.triangles[t];
    for (std::size_t k = 0; k < 3; ++k) {
      if (triangle.across[k] != kNoIndex) continue;
      const Index u = triangle.corner[(k + 1) % 3], v = triangle.corner[(k + 2) % 3];
      const Vec3 edge = reference.points[v] - reference.points[u];
      const Vec3 n = reference.normals[t], aside = normalized(cross(n, edge));
      Quadric line;
      for (const Vec3 normal : {n, aside}) {
        line.add_plane(normal, reference.points[u] - reference.points[0],
                       0.5 * kContourWeight * squared_norm(edge));
      }
      quadrics[u] += line;
      quadrics[v] += line;
    }
  }
}

Vec3 contour_point(const CertifiedContours& contours, Index loop, double at) {
  const auto& points = contours.loops[loop];
  const std::size_t i = static_cast<std::size_t>(at) % points.size();
  const double part = at - std::floor(at);
  return points[i] + (points[(i + 1) % points.size()] - points[i]) * part;
}

double contour_way(const CertifiedContours& contours, Index loop, double from, double to) {
  const double way = to - from;
  return way < 0 ? way + static_cast<double>(contours.loops[loop].size()) : way;
}

double nearest_station(const CertifiedContours& contours, Index loop, double from, double to, Vec3 p) {
  const auto& points = contours.loops[loop];
  const double size = static_cast<double>(points.size());
  const double end = from + contour_way(contours, loop, from, to);
  double best = from, least = 1e300;
  for (double begin = from; begin < end;) {
    const double stop = std::min(end, std::floor(begin) + 1);
    const Vec3 a = contour_point(contours, loop, begin), b = contour_point(contours, loop, stop);
    const double length2 = squared_norm(b - a);
    const double part = length2 > 0 ? std::clamp(dot(p - a, b - a) / length2, 0.0, 1.0) : 0;
    const double off2 = squared_norm(p - a - (b - a) * part);
    if (off2 < least) {
      least = off2;
      best = begin + (stop - begin) * part;
    }
    begin = stop;
  }
  return best < size ? best : best - size;
}

bool follows_contour(const CertifiedContours& contours, Index loop, double from, double to, Vec3 p, Vec3 q,
                     double tolerance) {
  const auto& points = contours.loops[loop];
  const double limit = tolerance * tolerance;
  if (squared_norm(contour_point(contours, loop, from) - p) > limit ||
      squared_norm(contour_point(contours, loop, to) - q) > limit) {
    return false;
  }
  const double end = from + contour_way(contours, loop, from, to);
  double reached = 0;
  for (auto i = static_cast<std::size_t>(from) + 1; static_cast<double>(i) < end; ++i) {
    double first = 0, last = 0;
    if (!near_part(p, q, points[i % points.size()], tolerance, first, last)) {
      return false;
    }
    reached = std::max(reached, first);
    if (reached > last) return false;
  }
  return true;
}

Vec3 onto_planes(const GridFrame& frame, std::uint8_t planes, Vec3 p) {
  if (planes == 0) return p;
  Vec3 q = frame.to_index(p);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (planes & 1u << (2 * axis)) q[axis] = 0;
    if (planes & 1u << (2 * axis + 1)) q[axis] = frame.dims[axis] - 1;
  }
  return frame.to_lps(q);
}

Vec3 across_contour(const GridFrame& frame, std::uint8_t planes, Vec3 along, Vec3 normal) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double side = planes & 1u << (2 * axis) ? -1 : 1;  // outwards
    if (planes & 3u << (2 * axis)) return normalized(cross(frame.direction.column[axis] * side, along));
  }
  return normalized(cross(normal, along));
}

}  // namespace periost
