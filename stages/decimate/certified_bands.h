#pragma once
// Decimating a joined mesh further, slab by slab (certified_pieces.h says why the proofs hold).
#include <cstdint>
#include <vector>

#include "pipeline/base/context.h"
#include "stages/decimate/certified_joined.h"
#include "stages/decimate/certified_slabs.h"
#include "stages/decimate/decimate.h"

namespace periost {

// Decimates what lies in a slab of the isosurface, the rest locked, with at most `removable` triangles fewer.
// `uses`: count_uses before any slab of the phase. Slabs of one phase may be taken in any order: each reads
// and writes what no other changes.
void decimate_slab(const Isosurface& isosurface, int axis, Slab slab, const std::vector<std::uint32_t>& uses,
                   std::size_t removable, DecimateOptions options, const Context& context,
                   JoinedMesh& joined);

// Decimates all slabs of a phase. `order`: in which, a permutation of their numbers.
void decimate_slabs(const Isosurface& isosurface, int axis, const std::vector<Slab>& slabs,
                    const std::vector<std::size_t>& order, const DecimateOptions& options,
                    const Context& context, JoinedMesh& joined);

}  // namespace periost
