#pragma once
// The second level of the iterative solver: the body cut into some hundred to 1,500 lumps of neighbouring
// nodes, each moving as a rigid body. The diagonal alone passes a force on by one element an iteration, so
// that a long or thin body takes thousands; the lumps carry it across the body at once (Nicolaides 1987, by
// rigid motions instead of constants). Lumps follow the matrix, not space: two walls that nearly touch stay
// apart.
#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "pipeline/base/context.h"
#include "pipeline/mechanics/stiffness.h"

namespace periost {

// The lump of each node, from 0; kNoIndex for a node without a tetrahedron. Lumps hold about `size` nodes,
// hang together, and have at least a third of that where the body allows.
std::vector<Index> lumps_of(const Stiffness& stiffness, std::size_t size);

class CoarseSpace {
 public:
  // Builds and factorises the matrix of the lumps' motions. `is_free`: three a node; what is not free does
  // not move. Memory: some 100 MB; seconds for a million nodes. Preconditions: `points` are the nodes'
  // places, and the supports and springs in `stiffness` hold the body.
  CoarseSpace(const Stiffness& stiffness, const std::vector<bool>& is_free, std::span<const Vec3> points,
              const Context& context);
  ~CoarseSpace();
  CoarseSpace(const CoarseSpace&) = delete;
  CoarseSpace& operator=(const CoarseSpace&) = delete;

  // Adds to `motion` the lumps' motions under the forces in `residual`; a symmetric, positive operator. The
  // same bits for any number of threads.
  void add_motion(std::span<const double> residual, std::span<double> motion, const Context& context) const;

 private:
  // The six motions of a node with its lump: for each axis the share in each of them.
  using Modes = std::array<std::array<double, 6>, 3>;
  struct Factors;

  void list_members(std::size_t lumps);
  void make_modes(const std::vector<bool>& is_free, std::span<const Vec3> points);
  void factorise(const Stiffness& stiffness, const Context& context);

  std::vector<Index> lump_;         // per node
  std::vector<std::size_t> first_;  // members of lump k: member_[first_[k]] .. member_[first_[k + 1] - 1]
  std::vector<Index> member_;
  std::vector<Modes> modes_;  // per node
  std::unique_ptr<Factors> factors_;
};

}  // namespace periost
