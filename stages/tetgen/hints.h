#pragma once
// A volume mesh as earlier rounds of feedback want it.
#include "pipeline/data/hints.h"
#include "stages/tetgen/tetgen.h"

namespace periost {

// The options with the places that hints add to `sizes.around`. `hints` may be null.
TetgenOptions with_hints(TetgenOptions options, const Hints* hints);

}  // namespace periost
