#include "stages/decimate/certified_seek.h"

#include <algorithm>
#include <cmath>

namespace periost {
namespace {

constexpr int kSteps = 12;
constexpr int kPatience = 4;       // so many steps must bring the worst cosine
constexpr double kProgress = 0.5;  // this part of the way to the limit
constexpr double kBeyond = 1.1;    // steps go a little further than needed
constexpr double kExtra = 1e-3;    // radians

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

// The triangle with the smallest angle; twice the cosine of that.
double find_worst(const CertifiedMesh& mesh, const Proposal& proposal, std::array<Vec3, 3>& corners) {
  double worst = -2;
  for (const LinkedTriangle& cell : proposal.cells) {
    const auto c = corners_from_place(mesh, proposal, cell);
    const double cosine = twice_largest_cosine(c);
    if (cosine <= worst) continue;
    worst = cosine;
    corners = c;
  }
  return worst;
}

}  // namespace

bool seek_angles(const CertifiedMesh& mesh, const GuardLimits& limits, const Quadric& quadric, Vec3 origin,
                 Vec3 normal, Proposal& proposal) {
  const double limit = 2 * std::cos(limits.min_angle);
  double earlier = 2;
  for (int step = 0; step < kSteps; ++step) {
    std::array<Vec3, 3> corners;
    const double worst = find_worst(mesh, proposal, corners);
    if (worst <= limit) {
      const double curvature = dot(normal, quadric.times(normal));
      if (!(curvature > 0)) return true;
      const Vec3 slope = quadric.times(proposal.place - origin) + quadric.b;
      proposal.place += normal * (-dot(normal, slope) / curvature);
      return meets_angles(mesh, proposal, limits);
    }
    if (step % kPatience == kPatience - 1) {
      if (worst - limit > kProgress * (earlier - limit)) return false;
      earlier = worst;
    }
    Vec3 gradient = smallest_angle_gradient(corners);
    gradient -= normal * dot(gradient, normal);
    const double size = squared_norm(gradient);
    if (!(size > 0)) return false;
    const double angle = std::acos(std::min(1.0, worst / 2));
    proposal.place += gradient * (kBeyond * (limits.min_angle - angle + kExtra) / size);
  }
  return false;
}

}  // namespace periost
