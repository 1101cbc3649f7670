#include "pipeline/mechanics/conditioning.h"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "pipeline/base/parallel.h"
#include "pipeline/base/random.h"
#include "pipeline/geometry/tet_faces.h"
#include "pipeline/geometry/tet_quality.h"
#include "pipeline/mechanics/solver.h"

namespace periost {
namespace {

constexpr Index kReferenceCells = 6;
constexpr double kBedLength = 2;  // in sizes of an element

template <int Unknowns>
double largest_eigenvalue(const ElementShape& shape, const LameConstants& lame) {
  Eigen::Matrix<double, Unknowns, Unknowns> matrix;
  for (std::size_t i = 0; i < shape.nodes; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      const Block block = stiffness_block(shape, lame, i, j);
      for (std::size_t k = 0; k < 9; ++k) {
        matrix(static_cast<Eigen::Index>(3 * i + k / 3), static_cast<Eigen::Index>(3 * j + k % 3)) = block[k];
      }
    }
  }
  // Eigen reads the lower half only.
  using Solver = Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, Unknowns, Unknowns>>;
  return Solver(matrix, Eigen::EigenvaluesOnly).eigenvalues()[Unknowns - 1];
}

double mean_tet_volume(const TetMesh& mesh) {
  double sum = 0;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) sum += tet_volume(tet_corners(mesh, t));
  return sum / static_cast<double>(mesh.tets.size());
}

// Points of the lattice: corners of cubes, then their centres.
struct Lattice {
  Index cells;
  Index corner(Index x, Index y, Index z) const { return x + (cells + 1) * (y + (cells + 1) * z); }
  Index centre(Index x, Index y, Index z) const {
    return (cells + 1) * (cells + 1) * (cells + 1) + x + cells * (y + cells * z);
  }
};

std::vector<Vec3> lattice_points(const Lattice& lattice, double side) {
  std::vector<Vec3> points;
  for (const double shift : {0.0, 0.5}) {
    const Index count = shift == 0 ? lattice.cells + 1 : lattice.cells;
    for (Index z = 0; z < count; ++z) {
      for (Index y = 0; y < count; ++y) {
        for (Index x = 0; x < count; ++x) points.push_back(side * Vec3{x + shift, y + shift, z + shift});
      }
    }
  }
  return points;
}

// The four tetrahedra around the segment from the centre of a cube to the centre of its neighbour in the
// direction of `axis`: one for each side of the square between them.
void add_tets_across(const Lattice& lattice, std::array<Index, 3> cube, std::size_t axis, TetMesh& mesh) {
  const Index from = lattice.centre(cube[0], cube[1], cube[2]);
  ++cube[axis];
  const Index to = lattice.centre(cube[0], cube[1], cube[2]);
  const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
  constexpr std::array<std::array<Index, 2>, 4> kAround{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
  std::array<Index, 4> square{};
  for (std::size_t k = 0; k < 4; ++k) {
    std::array<Index, 3> at = cube;
    at[u] += kAround[k][0];
    at[v] += kAround[k][1];
    square[k] = lattice.corner(at[0], at[1], at[2]);
  }
  for (std::size_t k = 0; k < 4; ++k) mesh.tets.push_back({from, square[k], square[(k + 1) % 4], to});
}

}  // namespace

TetMesh ideal_mesh(Index cells, double tet_volume, int order) {
  const Lattice lattice{cells};
  TetMesh mesh;
  mesh.points = lattice_points(lattice, std::cbrt(12 * tet_volume));
  for (Index z = 0; z < cells; ++z) {
    for (Index y = 0; y < cells; ++y) {
      for (Index x = 0; x < cells; ++x) {
        const std::array<Index, 3> cube{x, y, z};
        for (std::size_t axis = 0; axis < 3; ++axis) {
          if (cube[axis] + 1 < cells) add_tets_across(lattice, cube, axis, mesh);
        }
      }
    }
  }
  if (order == 2) add_midside_nodes(mesh);
  return mesh;
}

std::vector<double> largest_eigenvalues(const TetMesh& mesh, const Material& material,
                                        const Context& context) {
  constexpr std::size_t kTetsPerEigenTask = 512;
  const LameConstants lame = lame_constants(material);
  std::vector<double> largest(mesh.tets.size());
  parallel_blocks(context, largest.size(), kTetsPerEigenTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      const ElementShape shape = element_shape(mesh, t);
      largest[t] =
          shape.nodes == 4 ? largest_eigenvalue<12>(shape, lame) : largest_eigenvalue<30>(shape, lame);
    }
  });
  return largest;
}

std::size_t iterations_on_bed(const TetMesh& mesh, const Material& material, Stiffness& stiffness,
                              const Context& context) {
  const std::size_t per_tet = nodes_per_tet(mesh);
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    const double size = std::cbrt(6 * tet_volume(tet_corners(mesh, t)));
    const double spring =
        material.young_mpa * size / (6 * kBedLength * kBedLength * static_cast<double>(per_tet));
    for (std::size_t k = 0; k < per_tet; ++k) {
      const Index node = tet_node(mesh, t, k);
      Block& block = stiffness.blocks[stiffness.find(node, node)];
      for (std::size_t axis = 0; axis < 3; ++axis) block[4 * axis] += spring;
    }
  }
  LoadCase load_case;
  Random random(0, 0);
  for (Index node = 0; node < mesh.points.size(); ++node) {
    Vec3 force;
    for (std::size_t axis = 0; axis < 3; ++axis) force[axis] = 2 * random.uniform() - 1;
    load_case.loads.push_back({node, force});
  }
  return solve_iteratively(stiffness, load_case, {.tolerance = 1e-6}, context).iterations;
}

Conditioning conditioning(const TetMesh& mesh, const Material& material, Stiffness& stiffness,
                          const Context& context) {
  Conditioning result;
  if (mesh.tets.empty()) return result;
  const TetMesh ideal = ideal_mesh(kReferenceCells, mean_tet_volume(mesh), mesh.order());
  TetMesh one = ideal;
  one.tets.resize(1);
  one.midside.resize(mesh.order() == 2 ? 1 : 0);
  const double ideal_eigenvalue = largest_eigenvalues(one, material, context).front();
  result.eigenvalue_ratio = largest_eigenvalues(mesh, material, context);
  for (double& value : result.eigenvalue_ratio) value /= ideal_eigenvalue;
  Stiffness ideal_stiffness = assemble_stiffness(ideal, material, context);
  result.ideal_iterations = iterations_on_bed(ideal, material, ideal_stiffness, context);
  result.iterations = iterations_on_bed(mesh, material, stiffness, context);
  return result;
}

}  // namespace periost
