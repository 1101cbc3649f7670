#pragma once
// Moves points that are on no wall to where the smallest sine of the tetrahedra around is larger.
#include <vector>

#include "stages/improve/tet_complex.h"

namespace periost {

class TetSmoothing {
 public:
  explicit TetSmoothing(TetComplex& complex) : complex_(complex) {}

  // Moves a point whose star is below `target`: climbs (sine_quality.h), then tries the mean of the star's
  // other points. True when the star's smallest sine rose by more than kLeastGain; star() then holds the
  // tetrahedra, all of which changed. Points on walls stay.
  bool smooth(Index point, double target);

  // Of the last call.
  const std::vector<Index>& star() const { return star_; }

 private:
  TetComplex& complex_;
  std::vector<Index> star_;
  std::vector<TetFan> fans_;
};

}  // namespace periost
