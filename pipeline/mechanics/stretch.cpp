#include "pipeline/mechanics/stretch.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "pipeline/base/parallel.h"
#include "pipeline/geometry/distribution.h"
#include "pipeline/geometry/tet_faces.h"
#include "pipeline/mechanics/solver.h"

namespace periost {
namespace {

constexpr std::size_t kTetsPerTask = 4096;
constexpr double kTolerance = 1e-6;

// The bodies of `mesh` that reach both ends at half their thickness, as a mesh of the order asked for.
struct Spanning {
  TetMesh mesh;
  std::size_t bodies = 0, left_out = 0;
};

Spanning spanning_bodies(const TetMesh& mesh, const StretchFrame& frame, int order) {
  const auto component = tet_components(tet_neighbours(mesh.tets, mesh.points.size()));
  const std::size_t count = component.empty() ? 0 : 1 + *std::max_element(component.begin(), component.end());
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  std::vector<double> low(count, kInfinity), high(count, -kInfinity);
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    for (const Index corner : mesh.tets[t]) {
      low[component[t]] = std::min(low[component[t]], mesh.points[corner][frame.axis]);
      high[component[t]] = std::max(high[component[t]], mesh.points[corner][frame.axis]);
    }
  }
  Spanning result;
  std::vector<bool> spans(count);
  for (std::size_t c = 0; c < count; ++c) {
    spans[c] = low[c] < frame.low + 0.5 * frame.end() && high[c] > frame.high - 0.5 * frame.end();
    ++(spans[c] ? result.bodies : result.left_out);
  }
  // Points that are left without a tetrahedron have an empty row and no unknowns.
  result.mesh.points = mesh.points;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    if (!spans[component[t]]) continue;
    result.mesh.tets.push_back(mesh.tets[t]);
    if (mesh.order() == 2 && order == 2) result.mesh.midside.push_back(mesh.midside[t]);
  }
  if (result.mesh.order() < order) add_midside_nodes(result.mesh);
  return result;
}

// A point at which the bed is integrated: four a tetrahedron, of degree 2, on its corners alone.
struct BedPoint {
  std::array<double, 10> shape;  // values of the shape functions: four at first order, ten at second
  double spring = 0;             // N/mm
  bool is_above = false;
};

std::array<double, 10> shape_values(const std::array<double, 4>& l, int order) {
  std::array<double, 10> value{};
  if (order == 1) {
    std::copy(l.begin(), l.end(), value.begin());
    return value;
  }
  for (std::size_t i = 0; i < 4; ++i) value[i] = l[i] * (2 * l[i] - 1);
  for (std::size_t e = 0; e < 6; ++e) {
    value[4 + e] =
        4 * l[static_cast<std::size_t>(kTetEdge[e][0])] * l[static_cast<std::size_t>(kTetEdge[e][1])];
  }
  return value;
}

// Spring by volume at a place along the axis; 0 between the planes.
double bed_at(double place, const StretchFrame& frame, double young) {
  const double end = frame.end();
  const double depth = std::max(frame.low + end - place, place - (frame.high - end)) / end;
  return depth > 0 ? 16 * depth * young / (end * end) : 0;
}

std::array<BedPoint, 4> bed_points(const TetMesh& mesh, std::size_t tet, const StretchFrame& frame,
                                   double young) {
  const double near = (5 + 3 * std::sqrt(5.0)) / 20, far = (5 - std::sqrt(5.0)) / 20;
  const auto& [a, b, c, d] = mesh.tets[tet];
  const double volume = six_volumes(mesh.points[a], mesh.points[b], mesh.points[c], mesh.points[d]) / 6;
  std::array<BedPoint, 4> points{};
  for (std::size_t p = 0; p < 4; ++p) {
    std::array<double, 4> l{};
    double place = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      l[k] = k == p ? near : far;
      place += l[k] * mesh.points[mesh.tets[tet][k]][frame.axis];
    }
    points[p] = {shape_values(l, mesh.order()), 0.25 * volume * bed_at(place, frame, young),
                 place > 0.5 * (frame.low + frame.high)};
  }
  return points;
}

// The tetrahedra that the beds hold somewhere.
std::vector<std::size_t> bedded_tets(const TetMesh& mesh, const StretchFrame& frame) {
  std::vector<std::size_t> tets;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    for (const Index corner : mesh.tets[t]) {
      if (bed_at(mesh.points[corner][frame.axis], frame, 1) == 0) continue;
      tets.push_back(t);
      break;
    }
  }
  return tets;
}

// Adds the springs to the matrix and the pull of the bed above to the loads.
void add_beds(const TetMesh& mesh, const std::vector<std::size_t>& bedded, const StretchFrame& frame,
              double young, Stiffness& stiffness, LoadCase& load_case) {
  const std::size_t nodes = nodes_per_tet(mesh);
  for (const std::size_t t : bedded) {
    for (const BedPoint& point : bed_points(mesh, t, frame, young)) {
      if (point.spring == 0) continue;
      for (std::size_t i = 0; i < nodes; ++i) {
        const Index row = tet_node(mesh, t, i);
        for (std::size_t j = 0; j < nodes; ++j) {
          Block& block = stiffness.blocks[stiffness.find(row, tet_node(mesh, t, j))];
          for (std::size_t a = 0; a < 3; ++a) block[4 * a] += point.spring * point.shape[i] * point.shape[j];
        }
        if (!point.is_above) continue;
        NodalLoad load{row, {}};
        load.force[frame.axis] = point.spring * point.shape[i] * frame.displacement();
        load_case.loads.push_back(load);
      }
    }
  }
}

// Forces of the two beds on the body along the axis, upward.
struct BedForces {
  double below = 0, above = 0;
};

BedForces bed_forces(const TetMesh& mesh, const std::vector<std::size_t>& bedded, const StretchFrame& frame,
                     double young, const std::vector<Vec3>& displacement) {
  const std::size_t nodes = nodes_per_tet(mesh);
  BedForces forces;
  for (const std::size_t t : bedded) {
    for (const BedPoint& point : bed_points(mesh, t, frame, young)) {
      double moved = 0;
      for (std::size_t k = 0; k < nodes; ++k) {
        moved += point.shape[k] * displacement[tet_node(mesh, t, k)][frame.axis];
      }
      const double ground = point.is_above ? frame.displacement() : 0;
      (point.is_above ? forces.above : forces.below) += point.spring * (ground - moved);
    }
  }
  return forces;
}

// Strain energy by volume: Hooke's law the other way round.
double energy_density(const Stress& s, const Material& material) {
  const double trace = s[0] + s[1] + s[2];
  const double squares =
      s[0] * s[0] + s[1] * s[1] + s[2] * s[2] + 2 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]);
  return ((1 + material.poisson) * squares - material.poisson * trace * trace) / (2 * material.young_mpa);
}

// Strain energy, and the stresses away from the beds.
void measure_stress(const TetMesh& mesh, const StretchFrame& frame, const Material& material,
                    const std::vector<Vec3>& displacement, const Context& context, Stretch& result) {
  const LameConstants lame = lame_constants(material);
  const std::size_t tasks = (mesh.tets.size() + kTetsPerTask - 1) / kTetsPerTask;
  std::vector<double> energy(tasks);
  std::vector<std::vector<WeightedValue>> stresses(tasks);
  parallel_blocks(context, mesh.tets.size(), kTetsPerTask, [&](std::size_t begin, std::size_t end) {
    const std::size_t task = begin / kTetsPerTask;
    for (std::size_t t = begin; t < end; ++t) {
      const ElementShape shape = element_shape(mesh, t);
      std::array<Vec3, 10> moved;
      double place = 0;
      for (std::size_t k = 0; k < shape.nodes; ++k) moved[k] = displacement[tet_node(mesh, t, k)];
      for (const Index corner : mesh.tets[t]) place += 0.25 * mesh.points[corner][frame.axis];
      const double share = (place - frame.low) / frame.length();
      for (std::size_t p = 0; p < shape.points; ++p) {
        const Stress stress = stress_at(shape.at[p], lame, std::span(moved).first(shape.nodes));
        energy[task] += shape.at[p].volume * energy_density(stress, material);
        if (share > 0.2 && share < 0.8) stresses[task].push_back({von_mises(stress), shape.at[p].volume});
      }
    }
  });
  std::vector<WeightedValue> all;
  for (std::size_t task = 0; task < tasks; ++task) {
    result.energy += energy[task];
    all.insert(all.end(), stresses[task].begin(), stresses[task].end());
  }
  result.p95_von_mises = weighted_quantile(std::move(all), 0.95);
}

}  // namespace

StretchFrame stretch_frame(const TetMesh& mesh) {
  Vec3 low = mesh.points[mesh.tets.front()[0]], high = low;
  for (const Tetrahedron& tet : mesh.tets) {
    for (const Index corner : tet) {
      for (std::size_t a = 0; a < 3; ++a) {
        low[a] = std::min(low[a], mesh.points[corner][a]);
        high[a] = std::max(high[a], mesh.points[corner][a]);
      }
    }
  }
  std::size_t axis = 0;
  for (std::size_t a = 1; a < 3; ++a) {
    if (high[a] - low[a] > high[axis] - low[axis]) axis = a;
  }
  return {axis, low[axis], high[axis]};
}

std::size_t stretch_bytes(const TetMesh& mesh, int order) {
  return (order == 1 ? 600 : 4000) * mesh.tets.size();
}

std::optional<Stretch> stretch(const TetMesh& mesh, const StretchFrame& frame, const Material& material,
                               int order, const Context& context) {
  const Spanning body = spanning_bodies(mesh, frame, order);
  if (body.bodies == 0) return std::nullopt;
  Stiffness stiffness = assemble_stiffness(body.mesh, material, context);
  const std::vector<std::size_t> bedded = bedded_tets(body.mesh, frame);
  LoadCase load_case;
  add_beds(body.mesh, bedded, frame, material.young_mpa, stiffness, load_case);
  const Solution solution =
      solve_iteratively(stiffness, load_case, {.tolerance = kTolerance, .points = body.mesh.points}, context);

  Stretch result;
  const BedForces forces = bed_forces(body.mesh, bedded, frame, material.young_mpa, solution.displacement);
  result.stiffness = forces.above / frame.displacement();
  result.imbalance = std::abs(forces.above + forces.below) / std::abs(forces.above);
  measure_stress(body.mesh, frame, material, solution.displacement, context, result);
  result.tets = body.mesh.tets.size();
  for (std::size_t node = 0; node < stiffness.nodes(); ++node)
    result.nodes += stiffness.is_used(node) ? 1 : 0;
  result.bodies = body.bodies;
  result.left_out = body.left_out;
  result.iterations = solution.iterations;
  result.has_converged = solution.has_converged;
  return result;
}

}  // namespace periost
