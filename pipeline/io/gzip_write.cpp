#include "pipeline/io/gzip_write.h"

#define ZLIB_CONST  // input is declared const
#include <zlib.h>

#include <algorithm>
#include <vector>

#include "pipeline/base/error.h"

namespace periost {
namespace {

constexpr int kGzip = 15 + 16;
constexpr int kLevel = 4;  // on CT, level 6 takes twice the time for some two per cent less
constexpr std::size_t kBufferBytes = std::size_t{1} << 16;
constexpr unsigned char kUnknownSystem = 255;

}  // namespace

struct GzipWriter::State {
  AtomicFile& file;
  z_stream stream{};
  gz_header header{};
  std::vector<unsigned char> output = std::vector<unsigned char>(kBufferBytes);

  explicit State(AtomicFile& target) : file(target) {}
  ~State() { deflateEnd(&stream); }

  void push(int flush) {
    int result = Z_OK;
    do {
      stream.next_out = output.data();
      stream.avail_out = static_cast<uInt>(output.size());
      result = deflate(&stream, flush);
      file.write(output.data(), output.size() - stream.avail_out);
    } while (stream.avail_out == 0 || (flush == Z_FINISH && result == Z_OK));
  }
};

GzipWriter::GzipWriter(AtomicFile& file) : state_(std::make_unique<State>(file)) {
  if (deflateInit2(&state_->stream, kLevel, Z_DEFLATED, kGzip, 8, Z_DEFAULT_STRATEGY) != Z_OK) {
    throw Error(ErrorKind::kLimit, "memory.exhausted", "zlib cannot allocate its tables");
  }
  state_->header.os = kUnknownSystem;
  deflateSetHeader(&state_->stream, &state_->header);
}

GzipWriter::~GzipWriter() = default;

void GzipWriter::write(const void* data, std::size_t bytes) {
  constexpr std::size_t kMost = std::size_t{1} << 30;
  const auto* next = static_cast<const unsigned char*>(data);
  while (bytes > 0) {
    const std::size_t step = std::min(bytes, kMost);
    state_->stream.next_in = next;
    state_->stream.avail_in = static_cast<uInt>(step);
    state_->push(Z_NO_FLUSH);
    next += step;
    bytes -= step;
  }
}

void GzipWriter::finish() {
  state_->push(Z_FINISH);
}

}  // namespace periost
