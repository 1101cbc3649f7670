#pragma once
// What the tests of `method: paper` share.
#include "pipeline/data/simplex_mesh.h"
#include "stages/decimate/decimate.h"

namespace periost::test {

inline DecimateOptions paper_options(int pieces = 0) {
  DecimateOptions options;
  options.method = DecimateMethod::kPaper;
  options.distance = Length::voxel(0.4);
  options.pieces = pieces;
  return options;
}

inline bool same_bits(const SimplexMesh& a, const SimplexMesh& b) {
  return a.position == b.position && a.neighbour == b.neighbour && a.face == b.face &&
         a.valence == b.valence && a.dual_position == b.dual_position;
}

}  // namespace periost::test
