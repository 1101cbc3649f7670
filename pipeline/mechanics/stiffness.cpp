#include "pipeline/mechanics/stiffness.h"

#include <algorithm>
#include <numeric>

#include "pipeline/base/error.h"
#include "pipeline/base/parallel.h"

namespace periost {
namespace {

constexpr std::size_t kRowsPerTask = 1024;

// The tetrahedra around each node, ascending, as 16 * tet + number of the node in it.
struct NodeUses {
  std::vector<std::size_t> first;
  std::vector<std::size_t> use;
};

NodeUses uses_of_nodes(const TetMesh& mesh) {
  const std::size_t per_tet = nodes_per_tet(mesh);
  NodeUses uses;
  uses.first.assign(mesh.points.size() + 1, 0);
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    for (std::size_t k = 0; k < per_tet; ++k) ++uses.first[tet_node(mesh, t, k) + 1];
  }
  std::partial_sum(uses.first.begin(), uses.first.end(), uses.first.begin());
  uses.use.resize(uses.first.back());
  std::vector<std::size_t> next(uses.first.begin(), uses.first.end() - 1);
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    for (std::size_t k = 0; k < per_tet; ++k) uses.use[next[tet_node(mesh, t, k)]++] = 16 * t + k;
  }
  return uses;
}

// The nodes that share a tetrahedron with `node`, itself included, ascending.
void gather_neighbours(const TetMesh& mesh, const NodeUses& uses, std::size_t node,
                       std::vector<Index>& found) {
  found.clear();
  const std::size_t per_tet = nodes_per_tet(mesh);
  for (std::size_t u = uses.first[node]; u < uses.first[node + 1]; ++u) {
    for (std::size_t k = 0; k < per_tet; ++k) found.push_back(tet_node(mesh, uses.use[u] / 16, k));
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
}

// Where blocks may stand; their values are zero.
Stiffness pattern_of(const TetMesh& mesh, const NodeUses& uses, const Context& context) {
  Stiffness pattern;
  pattern.first.assign(mesh.points.size() + 1, 0);
  const auto each_row = [&](const auto& visit) {
    parallel_blocks(context, mesh.points.size(), kRowsPerTask, [&](std::size_t begin, std::size_t end) {
      std::vector<Index> found;
      for (std::size_t node = begin; node < end; ++node) {
        gather_neighbours(mesh, uses, node, found);
        visit(node, found);
      }
    });
  };
  each_row(
      [&](std::size_t node, const std::vector<Index>& found) { pattern.first[node + 1] = found.size(); });
  std::partial_sum(pattern.first.begin(), pattern.first.end(), pattern.first.begin());
  pattern.column.resize(pattern.first.back());
  pattern.blocks.resize(pattern.first.back());
  each_row([&](std::size_t node, const std::vector<Index>& found) {
    std::copy(found.begin(), found.end(),
              pattern.column.begin() + static_cast<std::ptrdiff_t>(pattern.first[node]));
  });
  return pattern;
}

void add_to_row(const TetMesh& mesh, const LameConstants& lame, std::size_t use, std::size_t row,
                Stiffness& stiffness) {
  const std::size_t tet = use / 16, i = use % 16;
  const ElementShape shape = element_shape(mesh, tet);
  for (std::size_t j = 0; j < shape.nodes; ++j) {
    const Block added = stiffness_block(shape, lame, i, j);
    Block& block = stiffness.blocks[stiffness.find(row, tet_node(mesh, tet, j))];
    for (std::size_t k = 0; k < 9; ++k) block[k] += added[k];
  }
}

}  // namespace

std::size_t Stiffness::find(std::size_t row, Index col) const {
  const auto begin = column.begin() + static_cast<std::ptrdiff_t>(first[row]);
  const auto end = column.begin() + static_cast<std::ptrdiff_t>(first[row + 1]);
  const auto found = std::lower_bound(begin, end, col);
  PERIOST_ASSERT(found != end && *found == col);
  return static_cast<std::size_t>(found - column.begin());
}

Stiffness assemble_stiffness(const TetMesh& mesh, const Material& material, const Context& context) {
  const LameConstants lame = lame_constants(material);
  const NodeUses uses = uses_of_nodes(mesh);
  Stiffness stiffness = pattern_of(mesh, uses, context);
  parallel_blocks(context, mesh.points.size(), kRowsPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t node = begin; node < end; ++node) {
      for (std::size_t u = uses.first[node]; u < uses.first[node + 1]; ++u) {
        add_to_row(mesh, lame, uses.use[u], node, stiffness);
      }
    }
  });
  return stiffness;
}

std::vector<std::size_t> folded_tets(const TetMesh& mesh, const Context& context) {
  std::vector<char> is_folded(mesh.tets.size());
  parallel_blocks(context, mesh.tets.size(), kRowsPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) is_folded[t] = is_regular(element_shape(mesh, t)) ? 0 : 1;
  });
  std::vector<std::size_t> folded;
  for (std::size_t t = 0; t < is_folded.size(); ++t) {
    if (is_folded[t] != 0) folded.push_back(t);
  }
  return folded;
}

void multiply(const Stiffness& stiffness, std::span<const double> x, std::span<double> product,
              const Context& context) {
  parallel_blocks(context, stiffness.nodes(), kRowsPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) {
      double sum[3] = {0, 0, 0};
      for (std::size_t b = stiffness.first[row]; b < stiffness.first[row + 1]; ++b) {
        const Block& k = stiffness.blocks[b];
        const double* u = &x[3 * std::size_t{stiffness.column[b]}];
        for (std::size_t a = 0; a < 3; ++a) {
          sum[a] += k[3 * a] * u[0] + k[3 * a + 1] * u[1] + k[3 * a + 2] * u[2];
        }
      }
      for (std::size_t a = 0; a < 3; ++a) product[3 * row + a] = sum[a];
    }
  });
}

}  // namespace periost
