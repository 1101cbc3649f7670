#include "stages/verify/hints.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "pipeline/geometry/measure_volume.h"
#include "pipeline/geometry/tet_quality.h"
#include "pipeline/geometry/triangle_quality.h"

namespace periost {
namespace {

constexpr double kSharper = 0.7;      // shorter edges, relative to the bad element's longest
constexpr double kRadius = 1.5;       // of a ball, relative to the same
constexpr double kLeastVoxels = 0.5;  // shortest edge asked for
constexpr std::size_t kMostBalls = 500;
constexpr double kMargin = 0.95;  // of the factor that would just do
constexpr double kLeastFactor = 0.5;
constexpr double kBlindFactor = 0.7;  // where the value does not tell by how much

struct KeyOf {
  const char* stage;
  const char* parameter;
};
constexpr KeyOf kRefine{"decimate", "refine"}, kDistance{"decimate", "distance"}, kSizes{"tetgen", "sizes"};

enum class Cause {
  kTriangles,   // bad ones, at places
  kTetrahedra,  // likewise
  kProportion,  // everywhere, in proportion
  kBlind,       // everywhere, by an unknown share
};

struct Rule {
  const char* metric;  // path, or the start of one
  Cause cause;
  double (*of_triangle)(Vec3, Vec3, Vec3) = nullptr;
  double (*of_tet)(const TetCorners&) = nullptr;
};

const Rule kRules[] = {
    {"surface.min_angle_deg.", Cause::kTriangles, triangle_min_angle_deg},
    {"surface.radius_ratio.", Cause::kTriangles, triangle_radius_ratio},
    {"surface.distance.over_requested", Cause::kBlind},
    {"surface.distance.", Cause::kProportion},
    {"surface.volume_change", Cause::kBlind},
    {"mechanics.reference.stiffness", Cause::kBlind},
    {"mechanics.reference.energy", Cause::kBlind},
    {"mechanics.reference.p95_von_mises", Cause::kBlind},
    {"volume.min_dihedral_deg.", Cause::kTetrahedra, nullptr,
     [](const TetCorners& t) { return tet_dihedral_range(t).min_deg; }},
    {"volume.max_dihedral_deg.", Cause::kTetrahedra, nullptr,
     [](const TetCorners& t) { return tet_dihedral_range(t).max_deg; }},
    {"volume.radius_ratio.", Cause::kTetrahedra, nullptr, tet_radius_ratio},
    {"volume.scaled_jacobian.", Cause::kTetrahedra, nullptr, tet_scaled_jacobian},
    {"volume.mean_ratio.", Cause::kTetrahedra, nullptr, tet_mean_ratio},
    {"volume.aspect_ratio.", Cause::kTetrahedra, nullptr, tet_aspect_ratio},
};

const Rule* rule_of(const std::string& metric) {
  const auto found = std::find_if(std::begin(kRules), std::end(kRules),
                                  [&](const Rule& rule) { return metric.rfind(rule.metric, 0) == 0; });
  return found == std::end(kRules) ? nullptr : found;
}

// Gates on the middle of a distribution do not single elements out.
bool is_about_elements(const std::string& metric) {
  const std::string word = metric.substr(metric.rfind('.') + 1);
  return word == "min" || word == "max" || word == "p01" || word == "p05" || word == "p95" || word == "p99";
}

struct BadElement {
  double excess = 0;  // beyond the limit, for the order
  std::size_t element = 0;
  Vec3 centre;
  double longest_edge = 0;
  bool is_at_surface = true;
};

// Collects the hints of one round.
class HintMaker {
 public:
  HintMaker(const QualityReport& report, const VerifyInputs& inputs)
      : report_(report), inputs_(inputs), hints_(inputs.hints != nullptr ? *inputs.hints : Hints{}) {
    note_.round = static_cast<std::uint32_t>(hints_.rounds.size() + 1);
    note_.verdict = report.verdict;
    voxel_mm_ = report.isosurface ? report.isosurface->voxel_mm : 0;
  }

  Hints run() {
    for (const GateResult& gate : report_.gates) {
      const Rule* rule = gate.status == Verdict::kFail && gate.limit ? rule_of(gate.metric) : nullptr;
      if (rule == nullptr) continue;
      if (rule->cause == Cause::kProportion || rule->cause == Cause::kBlind) {
        ask_everywhere(gate, *rule);
      } else if (is_about_elements(gate.metric)) {
        ask_at_places(gate, *rule);
      }
    }
    describe_changes();
    hints_.rounds.push_back(note_);
    return std::move(hints_);
  }

 private:
  void ask_everywhere(const GateResult& gate, const Rule& rule) {
    if (inputs_.simplex_mesh == nullptr) return;
    const double asked = rule.cause == Cause::kProportion
                             ? std::clamp(kMargin * *gate.limit / gate.value, kLeastFactor, kMargin)
                             : kBlindFactor;
    const double before = factor_on(inputs_.hints, kDistance.parameter);
    const double now = factor_on(&hints_, kDistance.parameter);
    if (before * asked >= now) return;  // another gate of this round asked for as much
    Hint hint = hint_on(kDistance, gate, "the surface is to keep closer to the isosurface");
    hint.factor = before * asked;
    hints_.hints.push_back(std::move(hint));
  }

  void ask_at_places(const GateResult& gate, const Rule& rule) {
    std::vector<BadElement> bad =
        rule.cause == Cause::kTriangles ? bad_triangles(gate, rule) : bad_tets(gate, rule);
    std::sort(bad.begin(), bad.end(), [](const BadElement& a, const BadElement& b) {
      return a.excess != b.excess ? a.excess > b.excess : a.element < b.element;
    });
    const bool is_decimated = inputs_.simplex_mesh != nullptr;
    const char* what = rule.cause == Cause::kTriangles ? "triangles" : "tetrahedra";
    Hint at_surface = hint_on(is_decimated ? kRefine : kSizes, gate,
                              fmt::format("{} at the surface are too large for their place", what));
    Hint inside = hint_on(kSizes, gate, fmt::format("{} inside are too large for their place", what));
    for (const BadElement& element : bad) add_ball(element, element.is_at_surface ? at_surface : inside);
    // What is wrong inside often goes back to the surface: its turn comes when nothing is left to do there.
    Hint& first = at_surface.balls.empty() ? inside : at_surface;
    if (!first.balls.empty()) hints_.hints.push_back(std::move(first));
  }

  Hint hint_on(const KeyOf& key, const GateResult& gate, const std::string& cause) const {
    return {.stage = key.stage,
            .parameter = key.parameter,
            .factor = 1,
            .balls = {},
            .metric = gate.metric,
            .value = gate.value,
            .limit = *gate.limit,
            .round = note_.round,
            .reason = fmt::format("{} is {:.4g}, the gate asks for {} {:.4g}: {}", gate.metric, gate.value,
                                  gate.op, *gate.limit, cause)};
  }

  void add_ball(const BadElement& element, Hint& hint) const {
    if (hint.balls.size() >= kMostBalls) return;
    double edge = element.longest_edge;
    for (const Hint& earlier : hints_.hints) {
      if (earlier.stage == hint.stage && earlier.round < hint.round)
        edge = std::min(edge, size_at(earlier, element.centre));
    }
    const HintBall ball{element.centre, kRadius * element.longest_edge,
                        std::max(kSharper * edge, kLeastVoxels * voxel_mm_)};
    const auto is_covered_by = [&](const Hint& other) {
      return other.stage == hint.stage && other.parameter == hint.parameter &&
             size_at(other, ball.centre_mm) <= ball.size_mm * (1 + kSlack);
    };
    if (is_covered_by(hint) || std::any_of(hints_.hints.begin(), hints_.hints.end(), is_covered_by)) return;
    hint.balls.push_back(ball);
  }

  // The smallest size that a hint asks for around a point: that of the balls whose inner half holds it.
  static double size_at(const Hint& hint, Vec3 point) {
    double size = kUnboundedMetric;
    for (const HintBall& ball : hint.balls) {
      if (distance(point, ball.centre_mm) <= 0.5 * ball.radius_mm) size = std::min(size, ball.size_mm);
    }
    return size;
  }

  // How far beyond the limit; not above 0 for an element that keeps it.
  static double excess_of(double value, const GateResult& gate) {
    return gate.op[0] == '<' ? value - *gate.limit : *gate.limit - value;
  }

  std::vector<BadElement> bad_triangles(const GateResult& gate, const Rule& rule) const {
    std::vector<BadElement> bad;
    if (inputs_.surface == nullptr) return bad;
    const SurfaceMesh& surface = *inputs_.surface;
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
      const Vec3 a = surface.points[surface.triangles[t][0]], b = surface.points[surface.triangles[t][1]],
                 c = surface.points[surface.triangles[t][2]];
      const double excess = excess_of(rule.of_triangle(a, b, c), gate);
      if (!(excess > 0)) continue;
      bad.push_back(
          {excess, t, (a + b + c) / 3, std::max({distance(a, b), distance(b, c), distance(c, a)}), true});
    }
    return bad;
  }

  std::vector<BadElement> bad_tets(const GateResult& gate, const Rule& rule) const {
    std::vector<BadElement> bad;
    if (inputs_.tet_mesh == nullptr) return bad;
    const TetMesh& mesh = *inputs_.tet_mesh;
    std::vector<bool> on_surface(mesh.points.size(), false), near_surface = on_surface;
    const SurfaceMesh boundary = boundary_surface(mesh);
    for (const Triangle& t : boundary.triangles) {
      for (const Index corner : t) on_surface[corner] = true;
    }
    for (const auto& tet : mesh.tets) {
      if (std::none_of(tet.begin(), tet.end(), [&](Index corner) { return on_surface[corner]; })) continue;
      for (const Index corner : tet) near_surface[corner] = true;
    }
    for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
      const TetCorners c = tet_corners(mesh, t);
      const double excess = excess_of(rule.of_tet(c), gate);
      if (!(excess > 0)) continue;
      double longest = 0;
      for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t k = i + 1; k < 4; ++k) longest = std::max(longest, distance(c[i], c[k]));
      }
      const bool is_at_surface = std::any_of(mesh.tets[t].begin(), mesh.tets[t].end(),
                                             [&](Index corner) { return near_surface[corner]; });
      bad.push_back({excess, t, (c[0] + c[1] + c[2] + c[3]) / 4, longest, is_at_surface});
    }
    return bad;
  }

  // What the hints of this round come to, by key, and why.
  void describe_changes() {
    struct Sum {
      std::size_t balls = 0;
      double least = kUnboundedMetric, factor = 1;
    };
    std::map<std::string, Sum> sums;
    for (const Hint& hint : hints_.hints) {
      if (hint.round != note_.round) continue;
      Sum& sum = sums[hint.stage + "." + hint.parameter];
      sum.balls += hint.balls.size();
      for (const HintBall& ball : hint.balls) sum.least = std::min(sum.least, ball.size_mm);
      sum.factor = std::min(sum.factor, hint.factor);
      note_.reason += (note_.reason.empty() ? "" : "; ") + hint.reason;
    }
    for (const auto& [key, sum] : sums) {
      note_.changed.push_back({key, sum.balls > 0
                                        ? fmt::format("{} places, edges from {:.3g} mm", sum.balls, sum.least)
                                        : distance_text(sum.factor)});
    }
  }

  std::string distance_text(double factor) const {
    const double mm = factor * configured_distance_mm(*inputs_.simplex_mesh, inputs_.hints);
    return voxel_mm_ > 0 ? fmt::format("{:.4g} voxel", mm / voxel_mm_) : fmt::format("{:.4g} mm", mm);
  }

  static constexpr double kSlack = 1e-9;

  const QualityReport& report_;
  const VerifyInputs& inputs_;
  Hints hints_;
  RoundNote note_;
  double voxel_mm_ = 0;
};

}  // namespace

Hints make_hints(const QualityReport& report, const VerifyInputs& inputs) {
  return HintMaker(report, inputs).run();
}

double configured_distance_mm(const SimplexMesh& mesh, const Hints* hints) {
  return mesh.report.requested_distance_mm / factor_on(hints, kDistance.parameter);
}

}  // namespace periost
