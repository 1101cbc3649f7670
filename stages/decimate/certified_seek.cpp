#include "stages/decimate/certified_seek.h"

#include <algorithm>

namespace periost {
namespace {

constexpr int kSteps = 12;
constexpr double kBeyond = 1.1;  // steps go a little further than needed
constexpr double kExtra = 1e-3;  // radians

// The place and the two other corners of a cell, in its order from the moved vertex on.
std::array<Vec3, 3> corners_from_place(const CertifiedMesh& mesh, const Proposal& proposal,
                                       const LinkedTriangle& cell) {
  const std::size_t k = cell.slot_of(proposal.moved);
  return {proposal.place, mesh.points[cell.corner[(k + 1) % 3]], mesh.points[cell.corner[(k + 2) % 3]]};
}

// The gradient of the smallest angle of a triangle with respect to its corner 0, in its plane, radians/mm;
// zero when degenerate.
Vec3 smallest_angle_gradient(const std::array<Vec3, 3>& c) {
  const Vec3 n = cross(c[1] - c[0], c[2] - c[0]);
  const double length = norm(n);
  if (!(length > 0)) return {};
  const double a = squared_norm(c[2] - c[1]), b = squared_norm(c[0] - c[2]), d = squared_norm(c[1] - c[0]);
  const Vec3 at1 = cross(n, c[0] - c[1]) / (length * d);     // of the angle at corner 1
  const Vec3 at2 = -(cross(n, c[0] - c[2]) / (length * b));  // at corner 2
  if (a <= b && a <= d) return -(at1 + at2);
  return b <= d ? at1 : at2;
}

// The cell with the smallest angle under the limit; false when there is none.
bool find_worst(const CertifiedMesh& mesh, const Proposal& proposal, double& angle,
                std::array<Vec3, 3>& corners) {
  bool is_found = false;
  for (const LinkedTriangle& cell : proposal.cells) {
    const auto c = corners_from_place(mesh, proposal, cell);
    const double own = min_angle(c);
    if (own >= angle) continue;
    angle = own;
    corners = c;
    is_found = true;
  }
  return is_found;
}

}  // namespace

bool seek_angles(const CertifiedMesh& mesh, const GuardLimits& limits, const Quadric& quadric, Vec3 origin,
                 Vec3 normal, Proposal& proposal) {
  for (int step = 0; step < kSteps; ++step) {
    double angle = limits.min_angle;
    std::array<Vec3, 3> corners;
    if (!find_worst(mesh, proposal, angle, corners)) {
      const double curvature = dot(normal, quadric.times(normal));
      if (!(curvature > 0)) return true;
      const Vec3 slope = quadric.times(proposal.place - origin) + quadric.b;
      proposal.place += normal * (-dot(normal, slope) / curvature);
      return meets_angles(mesh, proposal, limits);
    }
    Vec3 gradient = smallest_angle_gradient(corners);
    gradient -= normal * dot(gradient, normal);
    const double size = squared_norm(gradient);
    if (!(size > 0)) return false;
    proposal.place += gradient * (kBeyond * (limits.min_angle - angle + kExtra) / size);
  }
  return false;
}

}  // namespace periost
