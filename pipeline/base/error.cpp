#include "pipeline/base/error.h"

#include <cstdio>
#include <cstdlib>

namespace periost {

int exit_code(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::kInternal:
      return 1;
    case ErrorKind::kUsage:
      return 2;
    case ErrorKind::kQuality:
      return 3;
    case ErrorKind::kInput:
      return 4;
    case ErrorKind::kExternal:
      return 5;
    case ErrorKind::kLimit:
      return 6;
    case ErrorKind::kInterrupted:
      return 130;
  }
  return 1;
}

void assertion_failed(const char* condition, const char* file, int line) {
  std::fprintf(stderr, "%s:%d: assertion failed: %s\n", file, line, condition);
  std::abort();
}

}  // namespace periost
