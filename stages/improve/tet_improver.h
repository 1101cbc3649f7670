#pragma once
// The order of work: which tetrahedron is attacked next and by which means.
#include <cstddef>
#include <cstdint>
#include <queue>
#include <vector>

#include "pipeline/base/context.h"
#include "stages/improve/boundary_slide.h"
#include "stages/improve/slide_trial.h"
#include "stages/improve/tet_cavity.h"
#include "stages/improve/tet_removal.h"
#include "stages/improve/tet_smoothing.h"

namespace periost {

// What a round may do. Sines, as all that follows.
struct ImproveRound {
  double target = 0;  // tetrahedra below it are worked on
  bool is_inserting = false;
  double price = 0;  // of each tetrahedron that a new point brings: least rise of the smallest sine
  bool is_sliding = false;
  double gain = 0.02;  // least rise by a move of a boundary point, whose checks are dear
};

class TetImprover {
 public:
  // `slide`: the boundary, or null where it stays; all live on. `max_growth`: of the number of tetrahedra, as
  // a share of it.
  TetImprover(TetComplex& complex, BoundarySlide* slide, double max_growth, const Context& context);

  // Works on all tetrahedra below the target, worst first: edges and faces are taken out, points inside move,
  // new ones are put in, boundary points slide. Boundary points move in groups that do not depend on each
  // other, on all threads; groups are made by the data alone. New points are searched for in groups, too, and
  // put in one after the other, where what was found is still there.
  void round(const ImproveRound& round);

  // For the few tetrahedra that are left below `limit`: all means, with small gains and a wider search for
  // places on the boundary, for their own points and, until they reach the limit, for all that is around.
  void rescue(double limit);

  // The share of tetrahedra below `limit`.
  double share_below(double limit) const;

  // By how many tetrahedra the mesh may still grow.
  std::size_t room() const { return most_ > complex_.live ? most_ - complex_.live : 0; }

 private:
  // One queued tetrahedron; stale when its version is not that of the slot any more.
  struct Bad {
    double quality;
    Index tet;
    std::uint32_t version;
    // Worst first, then the lowest slot.
    bool operator<(const Bad& other) const {
      return quality != other.quality ? quality > other.quality : tet > other.tet;
    }
  };

  bool is_current(const Bad& bad) const {
    return complex_.is_live(bad.tet) && complex_.version[bad.tet] == bad.version;
  }
  void queue(Index tet);
  void queue_all(const std::vector<Index>& tets);
  void drain();
  bool attack(Index tet);
  void insert_group();
  bool smooth(Index point);
  void smooth_around(const std::vector<Index>& placed);
  void slide_group();
  bool try_corners(SlideTrial& trial, Index tet) const;
  std::vector<Bad> worst(double limit) const;
  std::vector<Index> points_around(Index tet) const;
  void rescue(Index tet, double limit);

  TetComplex& complex_;
  TetRemoval removal_;
  TetSmoothing smoothing_;
  BoundarySlide* slide_;
  const Context& context_;
  std::size_t most_;
  ImproveRound round_;
  std::priority_queue<Bad> queue_;
  std::vector<Index> points_;
  std::vector<Bad> insert_group_;  // tetrahedra around which points are to be put in
  std::vector<TetCavity> cavities_;
  std::vector<Bad> group_;  // tetrahedra for which boundary points are to move
  std::vector<ImproveBox> reach_;
  std::vector<SlideTrial> trials_;
};

}  // namespace periost
