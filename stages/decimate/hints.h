#pragma once
// Decimation as earlier rounds of feedback want it.
#include "pipeline/data/hints.h"
#include "stages/decimate/decimate.h"

namespace periost {

// The options, sharpened. Hints on `distance` shorten it; those on `refine` are further places of it. `paper`
// has no such places: it keeps a smaller distance, by a fifth for every round that asked for some. `hints`
// may be null.
DecimateOptions with_hints(DecimateOptions options, const Hints* hints);

}  // namespace periost
