#include "stages/decimate/certified_contour_deform.h"

#include "pipeline/geometry/simplex_geometry.h"

namespace periost {
namespace {

bool is_free(const CertifiedState& state, Index v) {
  return state.mesh.contour[v] == kOnContour && state.contours.slot[v] != kNoIndex;
}

// The vertex against its neighbours along the contour.
SimplexParameters parameters_at(const CertifiedState& state, Index v) {
  const Vec3 p = state.mesh.points[v], a = state.mesh.points[contour_previous(state.mesh, v)],
             b = state.mesh.points[contour_next(state.mesh, v)];
  const Vec3 along = b - a;
  const double length2 = squared_norm(along);
  SimplexParameters result;
  result.normal = across_contour(state.reference.frame(), state.contours.of(v).planes, along,
                                 state.reference.normals[state.mesh.nearest[v]]);
  result.is_degenerate = !(length2 > 0) || result.normal == Vec3{};
  if (result.is_degenerate) return result;
  const double t = dot(p - a, along) / length2;
  result.barycentric = {1 - t, t, 0};
  result.height = dot(p - a, result.normal);
  result.foot = a + along * t;
  result.power = t * (1 - t) * length2;
  result.circumradius = 0.5 * std::sqrt(length2);
  return result;
}

// The mean angle over Q^s.
double mean_angle_along(const CertifiedState& state, Index v, int extent) {
  double sum = simplex_angle(parameters_at(state, v));
  int count = 1;
  for (const bool forwards : {true, false}) {
    Index at = v;
    for (int step = 0; step < extent; ++step) {
      at = forwards ? contour_next(state.mesh, at) : contour_previous(state.mesh, at);
      if (at == v || !is_free(state, at) || state.contours.of(at).planes != state.contours.of(v).planes)
        break;
      const SimplexParameters parameters = parameters_at(state, at);
      if (parameters.is_degenerate) break;
      sum += simplex_angle(parameters);
      ++count;
    }
  }
  return sum / count;
}

}  // namespace

void deform_contours(const CertifiedState& state, const DecimateOptions& options,
                     const std::vector<Vec3>& previous, std::vector<Vec3>& places) {
  const CertifiedMesh& mesh = state.mesh;
  const CertifiedContours& contours = state.contours;
  for (Index v = 0; v < mesh.contour.size(); ++v) {
    if (mesh.incident[v] == kNoIndex || !is_free(state, v)) continue;
    const SimplexParameters at = parameters_at(state, v);
    if (at.is_degenerate) continue;
    const Index before = contour_previous(mesh, v), after = contour_next(mesh, v);
    const double angle = mean_angle_along(state, v, options.rigidity);
    const double rise = height_at_angle(angle, at.power, at.circumradius) - at.height;
    const ContourStation& station = contours.of(v);
    const double nearest = nearest_station(contours, station.loop, contours.of(before).at,
                                           contours.of(after).at, mesh.points[v]);
    const double pull = dot(contour_point(contours, station.loop, nearest) - mesh.points[v], at.normal);
    const Vec3 middle = (mesh.points[before] + mesh.points[after]) * 0.5;
    places[v] =
        mesh.points[v] + (middle - at.foot) * 0.5 + at.normal * (0.5 * rise + options.stiffness * pull);
    if (!previous.empty()) places[v] += (mesh.points[v] - previous[v]) * (1 - options.damping);
  }
}

}  // namespace periost
