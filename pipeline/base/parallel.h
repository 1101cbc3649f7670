#pragma once
// Deterministic data parallelism: work is cut by the data, never by the number of threads, so results are the
// same for 1..N threads as long as each piece writes only its own part.
#include <cstddef>
#include <functional>

#include "pipeline/base/context.h"

namespace periost {

// Calls body(piece) once for every piece in [0, pieces), on at most context.threads threads. The first
// exception is rethrown after running pieces end; cancellation is polled before each piece.
void parallel_for(const Context& context, std::size_t pieces, const std::function<void(std::size_t)>& body);

// Cuts [0, count) into blocks of `block` items and calls body(begin, end) for each. Precondition: block > 0.
void parallel_blocks(const Context& context, std::size_t count, std::size_t block,
                     const std::function<void(std::size_t, std::size_t)>& body);

}  // namespace periost
