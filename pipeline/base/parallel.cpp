#include "pipeline/base/parallel.h"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>

namespace periost {

void parallel_for(const Context& context, std::size_t pieces, const std::function<void(std::size_t)>& body) {
  if (context.threads <= 1 || pieces <= 1) {
    for (std::size_t piece = 0; piece < pieces; ++piece) {
      context.check_cancelled();
      body(piece);
    }
    return;
  }
  tbb::task_arena arena(context.threads);
  arena.execute([&] {
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, pieces, 1),
        [&](const tbb::blocked_range<std::size_t>& range) {
          for (std::size_t piece = range.begin(); piece != range.end(); ++piece) {
            context.check_cancelled();
            body(piece);
          }
        },
        tbb::simple_partitioner());
  });
}

void parallel_blocks(const Context& context, std::size_t count, std::size_t block,
                     const std::function<void(std::size_t, std::size_t)>& body) {
  parallel_for(context, (count + block - 1) / block, [&](std::size_t piece) {
    const std::size_t begin = piece * block;
    body(begin, std::min(begin + block, count));
  });
}

}  // namespace periost
