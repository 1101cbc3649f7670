#include "pipeline/mechanics/rigid_modes.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "pipeline/geometry/disjoint_sets.h"
#include "pipeline/geometry/tet_faces.h"
#include "pipeline/mechanics/solver.h"

namespace periost {
namespace {

constexpr std::size_t kLargestFactorised = 6000;  // unknowns
constexpr std::size_t kMostBodies = 200;          // 6 * 200 unknowns: a dense matrix of 11 MB
constexpr double kNoEnergy = 1e-11;
constexpr double kLargestRigidError = 1e-10;

struct Extent {
  Vec3 middle;
  double radius = 1;
};

Extent extent_of(const std::vector<Vec3>& points) {
  Extent extent;
  if (points.empty()) return extent;
  for (const Vec3& p : points) extent.middle += p / static_cast<double>(points.size());
  extent.radius = 0;
  for (const Vec3& p : points) extent.radius = std::max(extent.radius, distance(p, extent.middle));
  return extent;
}

// Displacement at a place by rigid motion k of six: translations, then rotations that move the far end by 1.
Vec3 rigid_motion(const Extent& extent, Vec3 place, std::size_t k) {
  Vec3 axis;
  axis[k % 3] = 1;
  return k < 3 ? axis : cross(axis, (place - extent.middle) / extent.radius);
}

// One motion's residual, row by row relative to what the row could hold.
double residual_of_motion(const Stiffness& stiffness, const std::vector<double>& motion,
                          const Context& context) {
  std::vector<double> product(motion.size());
  multiply(stiffness, motion, product, context);
  double error = 0;
  for (std::size_t k = 0; k < product.size(); ++k) {
    double row_sum = 0;
    for (std::size_t b = stiffness.first[k / 3]; b < stiffness.first[k / 3 + 1]; ++b) {
      for (std::size_t j = 0; j < 3; ++j) row_sum += std::abs(stiffness.blocks[b][3 * (k % 3) + j]);
    }
    if (row_sum > 0) error = std::max(error, std::abs(product[k]) / row_sum);
  }
  return error;
}

// Pairs of bodies that share a node without sharing a face, one pair for each further body at a node.
struct Joint {
  Index node = 0;
  std::uint32_t first = 0, second = 0;
};

std::vector<Joint> joints_of(const TetMesh& mesh, const std::vector<std::uint32_t>& body) {
  std::vector<std::pair<Index, std::uint32_t>> uses;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    for (std::size_t k = 0; k < nodes_per_tet(mesh); ++k) uses.emplace_back(tet_node(mesh, t, k), body[t]);
  }
  std::sort(uses.begin(), uses.end());
  uses.erase(std::unique(uses.begin(), uses.end()), uses.end());
  std::vector<Joint> joints;
  for (std::size_t u = 1; u < uses.size(); ++u) {
    if (uses[u].first == uses[u - 1].first) {
      joints.push_back({uses[u].first, uses[u - 1].second, uses[u].second});
    }
  }
  return joints;
}

// What is left as bodies when all that share a node count as one.
std::size_t joined_bodies(const std::vector<Joint>& joints, std::size_t parts) {
  DisjointSets sets(parts);
  for (const Joint& joint : joints) sets.unite(joint.first, joint.second);
  std::size_t bodies = 0;
  for (Index part = 0; part < parts; ++part) bodies += sets.find(part) == part ? 1 : 0;
  return bodies;
}

// Motions of all bodies, six unknowns each, that agree wherever two share a node: the kernel of J^T J, with
// three rows of J for each joint.
std::size_t motions_that_agree(const TetMesh& mesh, const std::vector<Joint>& joints, std::size_t bodies) {
  const Extent extent = extent_of(mesh.points);
  const auto unknowns = static_cast<Eigen::Index>(6 * bodies);
  Eigen::MatrixXd squares = Eigen::MatrixXd::Zero(unknowns, unknowns);
  for (const Joint& joint : joints) {
    const auto rows = Eigen::Index{6} * joint.first, columns = Eigen::Index{6} * joint.second;
    Eigen::Matrix<double, 3, 6> moves;
    for (std::size_t k = 0; k < 6; ++k) {
      const Vec3 move = rigid_motion(extent, mesh.points[joint.node], k);
      moves.col(static_cast<Eigen::Index>(k)) << move.x, move.y, move.z;
    }
    const Eigen::Matrix<double, 6, 6> square = moves.transpose() * moves;
    squares.block<6, 6>(rows, rows) += square;
    squares.block<6, 6>(columns, columns) += square;
    squares.block<6, 6>(rows, columns) -= square;
    squares.block<6, 6>(columns, rows) -= square;
  }
  const Eigen::VectorXd values =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(squares, Eigen::EigenvaluesOnly).eigenvalues();
  constexpr double kRounding = 1e-13;
  return static_cast<std::size_t>((values.array() <= kRounding * values.maxCoeff()).count());
}

}  // namespace

RigidModes rigid_modes_by_connectivity(const TetMesh& mesh) {
  if (mesh.tets.empty()) return {};
  const auto body = tet_components(tet_neighbours(mesh.tets, mesh.points.size()));
  const std::size_t parts = std::size_t{1} + *std::max_element(body.begin(), body.end());
  const std::vector<Joint> joints = parts == 1 ? std::vector<Joint>{} : joints_of(mesh, body);
  RigidModes modes;
  modes.count = joints.empty() || parts > kMostBodies ? 6 * parts : motions_that_agree(mesh, joints, parts);
  modes.bodies = joined_bodies(joints, parts);
  return modes;
}

RigidModes rigid_modes(const TetMesh& mesh, const Stiffness& stiffness, const Context& context) {
  RigidModes modes = rigid_modes_by_connectivity(mesh);
  const std::size_t unknowns = 3 * stiffness.nodes();
  if (unknowns <= kLargestFactorised) {
    modes.count = std::max(modes.count, count_eigenvalues_below(stiffness, kNoEnergy));
  }
  const Extent extent = extent_of(mesh.points);
  std::vector<double> motion(unknowns);
  for (std::size_t k = 0; k < 6; ++k) {
    for (std::size_t i = 0; i < unknowns; ++i) {
      motion[i] = rigid_motion(extent, mesh.points[i / 3], k)[i % 3];
    }
    const double error = residual_of_motion(stiffness, motion, context);
    modes.error = std::max(modes.error, error);
    if (!(error <= kLargestRigidError) && modes.count > 0) --modes.count;
  }
  return modes;
}

}  // namespace periost
