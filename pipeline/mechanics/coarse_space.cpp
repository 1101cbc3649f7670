#include "pipeline/mechanics/coarse_space.h"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "pipeline/base/parallel.h"

namespace periost {
namespace {

constexpr std::size_t kMostLumps = 1500, kSmallestLump = 30, kLumpsPerTask = 16;

// Grows one lump around `seed` through nodes that have none yet, nearest in the matrix first.
std::vector<Index> grow(const Stiffness& stiffness, Index seed, Index number, std::size_t size,
                        std::vector<Index>& lump) {
  std::vector<Index> members{seed};
  lump[seed] = number;
  for (std::size_t k = 0; k < members.size(); ++k) {
    const Index node = members[k];
    for (std::size_t b = stiffness.first[node]; b < stiffness.first[node + 1]; ++b) {
      if (members.size() >= size) return members;
      const Index other = stiffness.column[b];
      if (lump[other] != kNoIndex) continue;
      lump[other] = number;
      members.push_back(other);
    }
  }
  return members;
}

// Another lump that touches these nodes, or their own when there is none.
Index neighbour_of(const Stiffness& stiffness, const std::vector<Index>& members,
                   const std::vector<Index>& lump) {
  const Index own = lump[members.front()];
  for (const Index node : members) {
    for (std::size_t b = stiffness.first[node]; b < stiffness.first[node + 1]; ++b) {
      if (lump[stiffness.column[b]] != own) return lump[stiffness.column[b]];
    }
  }
  return own;
}

// Numbers the lumps in use from 0 on; returns how many there are.
std::size_t renumber(std::vector<Index>& lump, std::size_t count) {
  std::vector<Index> number(count, kNoIndex);
  Index next = 0;
  for (Index& l : lump) {
    if (l == kNoIndex) continue;
    if (number[l] == kNoIndex) number[l] = next++;
    l = number[l];
  }
  return next;
}

// A 6 x 6 block of the lumps' matrix.
struct LumpBlock {
  Index other = 0;
  std::array<double, 36> values{};
};

template <class Entry>
Entry& entry_for(std::vector<Entry>& entries, Index other) {
  for (Entry& entry : entries) {
    if (entry.other == other) return entry;
  }
  entries.push_back({other, {}});
  return entries.back();
}

}  // namespace

struct CoarseSpace::Factors {
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower> solver;
};

std::vector<Index> lumps_of(const Stiffness& stiffness, std::size_t size) {
  std::vector<Index> lump(stiffness.nodes(), kNoIndex);
  std::vector<std::vector<Index>> small;
  std::size_t count = 0;
  for (Index node = 0; node < stiffness.nodes(); ++node) {
    if (!stiffness.is_used(node) || lump[node] != kNoIndex) continue;
    std::vector<Index> members = grow(stiffness, node, static_cast<Index>(count++), size, lump);
    if (3 * members.size() < size) small.push_back(std::move(members));
  }
  for (const std::vector<Index>& members : small) {
    const Index other = neighbour_of(stiffness, members, lump);
    for (const Index node : members) lump[node] = other;
  }
  renumber(lump, count);
  return lump;
}

CoarseSpace::CoarseSpace(const Stiffness& stiffness, const std::vector<bool>& is_free,
                         std::span<const Vec3> points, const Context& context)
    : lump_(lumps_of(stiffness, std::max(kSmallestLump, stiffness.nodes() / kMostLumps))),
      factors_(std::make_unique<Factors>()) {
  std::size_t lumps = 0;
  for (const Index l : lump_) lumps = l == kNoIndex ? lumps : std::max<std::size_t>(lumps, l + 1);
  list_members(lumps);
  make_modes(is_free, points);
  factorise(stiffness, context);
}

CoarseSpace::~CoarseSpace() = default;

void CoarseSpace::list_members(std::size_t lumps) {
  first_.assign(lumps + 1, 0);
  for (const Index l : lump_) {
    if (l != kNoIndex) ++first_[l + 1];
  }
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
  member_.resize(first_.back());
  std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
  for (Index node = 0; node < lump_.size(); ++node) {
    if (lump_[node] != kNoIndex) member_[next[lump_[node]]++] = node;
  }
}

// Rotations are about the lump's middle and scaled by its radius, so that all six motions are of one size.
void CoarseSpace::make_modes(const std::vector<bool>& is_free, std::span<const Vec3> points) {
  modes_.resize(lump_.size());
  for (std::size_t l = 0; l + 1 < first_.size(); ++l) {
    Vec3 centre;
    for (std::size_t m = first_[l]; m < first_[l + 1]; ++m) centre += points[member_[m]];
    centre = centre / static_cast<double>(first_[l + 1] - first_[l]);
    double radius = 0;
    for (std::size_t m = first_[l]; m < first_[l + 1]; ++m) {
      radius = std::max(radius, distance(points[member_[m]], centre));
    }
    for (std::size_t m = first_[l]; m < first_[l + 1]; ++m) {
      const Index node = member_[m];
      const Vec3 r = radius > 0 ? (points[node] - centre) / radius : Vec3{};
      modes_[node] = {{{1, 0, 0, 0, r.z, -r.y}, {0, 1, 0, -r.z, 0, r.x}, {0, 0, 1, r.y, -r.x, 0}}};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (!is_free[3 * std::size_t{node} + axis]) modes_[node][axis] = {};
      }
    }
  }
}

void CoarseSpace::factorise(const Stiffness& stiffness, const Context& context) {
  const std::size_t lumps = first_.size() - 1;
  std::vector<std::vector<LumpBlock>> rows(lumps);
  parallel_blocks(context, lumps, kLumpsPerTask, [&](std::size_t begin, std::size_t end) {
    struct Moved {  // stiffness of one node times the motions of another lump
      Index other = 0;
      std::array<double, 18> values{};
    };
    std::vector<Moved> moved;
    for (std::size_t l = begin; l < end; ++l) {
      for (std::size_t m = first_[l]; m < first_[l + 1]; ++m) {
        const Index node = member_[m];
        moved.clear();
        for (std::size_t b = stiffness.first[node]; b < stiffness.first[node + 1]; ++b) {
          const Index column = stiffness.column[b];
          if (lump_[column] > l) continue;
          auto& values = entry_for(moved, lump_[column]).values;
          const Block& k = stiffness.blocks[b];
          for (std::size_t a = 0; a < 3; ++a) {
            for (std::size_t c = 0; c < 3; ++c) {
              for (std::size_t q = 0; q < 6; ++q) values[6 * a + q] += k[3 * a + c] * modes_[column][c][q];
            }
          }
        }
        for (const Moved& other : moved) {
          auto& values = entry_for(rows[l], other.other).values;
          for (std::size_t p = 0; p < 6; ++p) {
            for (std::size_t a = 0; a < 3; ++a) {
              for (std::size_t q = 0; q < 6; ++q) {
                values[6 * p + q] += modes_[node][a][p] * other.values[6 * a + q];
              }
            }
          }
        }
      }
    }
  });
  // A lump of collinear nodes cannot tell a rotation about their line: a trace on the diagonal keeps it out.
  constexpr double kTrace = 1e-8;
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t l = 0; l < lumps; ++l) {
    for (const LumpBlock& block : rows[l]) {
      for (std::size_t k = 0; k < 36; ++k) {
        const std::size_t row = 6 * l + k / 6, column = 6 * std::size_t{block.other} + k % 6;
        if (row < column) continue;
        const double value = row != column              ? block.values[k]
                             : block.values[k] > 1e-300 ? (1 + kTrace) * block.values[k]
                                                        : 1;
        entries.emplace_back(static_cast<int>(row), static_cast<int>(column), value);
      }
    }
  }
  const auto unknowns = static_cast<Eigen::Index>(6 * lumps);
  Eigen::SparseMatrix<double> matrix(unknowns, unknowns);
  matrix.setFromTriplets(entries.begin(), entries.end());
  factors_->solver.compute(matrix);
}

void CoarseSpace::add_motion(std::span<const double> residual, std::span<double> motion,
                             const Context& context) const {
  if (factors_->solver.info() != Eigen::Success) return;  // then the diagonal is all there is
  const std::size_t lumps = first_.size() - 1;
  Eigen::VectorXd force = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(6 * lumps));
  parallel_blocks(context, lumps, kLumpsPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t m = first_[begin]; m < first_[end]; ++m) {
      const Index node = member_[m];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        for (std::size_t q = 0; q < 6; ++q) {
          force[static_cast<Eigen::Index>(6 * std::size_t{lump_[node]} + q)] +=
              modes_[node][axis][q] * residual[3 * std::size_t{node} + axis];
        }
      }
    }
  });
  const Eigen::VectorXd moved = factors_->solver.solve(force);
  parallel_blocks(context, lumps, kLumpsPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t m = first_[begin]; m < first_[end]; ++m) {
      const Index node = member_[m];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        for (std::size_t q = 0; q < 6; ++q) {
          motion[3 * std::size_t{node} + axis] +=
              modes_[node][axis][q] * moved[static_cast<Eigen::Index>(6 * std::size_t{lump_[node]} + q)];
        }
      }
    }
  });
}

}  // namespace periost
