#pragma once
#include <filesystem>

#include "pipeline/base/context.h"

namespace periost::test {

// A context that finds the worker programs of this build.
inline Context worker_context() {
  Context context;
  context.workers = std::filesystem::path(PERIOST_BUILD_DIR) / "bin";
  return context;
}

}  // namespace periost::test
