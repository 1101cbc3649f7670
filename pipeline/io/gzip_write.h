#pragma once
// A gzip stream into a file that appears whole or not at all. The same bytes in give the same bytes out: the
// header carries no time, no name and no system.
#include <cstddef>
#include <memory>

#include "pipeline/base/file.h"

namespace periost {

class GzipWriter {
 public:
  // `file` must outlive the writer; its commit stays with the caller, after finish().
  explicit GzipWriter(AtomicFile& file);
  ~GzipWriter();
  GzipWriter(const GzipWriter&) = delete;
  GzipWriter& operator=(const GzipWriter&) = delete;

  // Both throw as AtomicFile::write.
  void write(const void* data, std::size_t bytes);
  void finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace periost
