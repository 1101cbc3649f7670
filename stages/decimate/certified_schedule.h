#pragma once
// The schedule of the certified scheme: which passes, in what order, over which regions of space.
//
// Removals in stages, each up to the median cost of what is left; rounds of removals at any cost, each with
// swaps, relocations and the mending of bad angles; the law of motion; fits until the enclosed volume is what
// it was; and the mending of slivers, in regions first, then in all of space, at last by many moves at once.
// Every pass but the last few runs on several regions at a time (certified_regions.h).
#include "stages/decimate/certified_moves.h"
#include "stages/decimate/decimate.h"

namespace periost {

// How far the schedule runs: through the removals in stages by cost, or altogether.
enum class Extent { kByCost, kToTheEnd };

// Changes the state by certified moves only, so its invariants (certified.h) hold before and after. The same
// bits for any number of threads. Throws Error{kInterrupted}.
MoveCounts run_certified_schedule(CertifiedState& state, const DecimateOptions& options, Extent extent,
                                  const Context& context);

}  // namespace periost
