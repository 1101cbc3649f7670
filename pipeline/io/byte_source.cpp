#include "pipeline/io/byte_source.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <vector>

#include "pipeline/base/error.h"

namespace periost {
namespace {

constexpr std::size_t kBufferBytes = std::size_t{1} << 18;
// A deflate block codes at most 258 bytes in 2 bits; 1032 is the known limit of the format.
constexpr std::uint64_t kLargestRatio = 1032;
constexpr int kGzipOrZlib = 15 + 32;

bool begins_as_gzip(const std::array<unsigned char, 2>& magic) {
  return magic[0] == 0x1f && magic[1] == 0x8b;
}
// A zlib header: deflate, window of at most 32 KiB, check bits.
bool begins_as_zlib(const std::array<unsigned char, 2>& magic) {
  return (magic[0] & 0x0f) == 8 && (magic[0] >> 4) <= 7 && (magic[0] * 256 + magic[1]) % 31 == 0;
}

}  // namespace

void refuse_file(const std::filesystem::path& path, const std::string& code, const std::string& text,
                 const std::string& hint) {
  throw Error(ErrorKind::kInput, code, fmt::format("'{}' {}", path.filename().string(), text), hint);
}

struct ByteSource::State {
  std::filesystem::path path;
  int descriptor = -1;
  std::uint64_t file_bytes = 0;
  std::uint64_t taken = 0;     // bytes of the file that were read, from its beginning
  std::uint64_t position = 0;  // decoded bytes delivered
  bool is_compressed = false;
  bool has_stream = false;
  bool is_at_end = false;
  z_stream stream{};
  std::vector<unsigned char> input;

  ~State() {
    if (has_stream) inflateEnd(&stream);
    if (descriptor >= 0) ::close(descriptor);
  }

  std::size_t read_file(void* to, std::size_t bytes) {
    std::size_t done = 0;
    while (done < bytes) {
      const ssize_t got = ::read(descriptor, static_cast<char*>(to) + done, bytes - done);
      if (got < 0 && errno == EINTR) continue;
      if (got < 0) {
        refuse_file(path, "image.unreadable",
                    fmt::format("cannot be read at byte {}: {}", taken, std::strerror(errno)));
      }
      if (got == 0) break;
      done += static_cast<std::size_t>(got);
      taken += static_cast<std::uint64_t>(got);
    }
    return done;
  }

  void refill() {
    if (stream.avail_in > 0) return;
    stream.avail_in = static_cast<uInt>(read_file(input.data(), input.size()));
    stream.next_in = input.data();
  }

  // After one gzip member another may follow; anything else behind it is ignored, as gzip itself does.
  void start_next_member() {
    refill();
    if (stream.avail_in >= 2 && begins_as_gzip({stream.next_in[0], stream.next_in[1]})) {
      inflateReset(&stream);
    } else {
      is_at_end = true;
    }
  }

  std::size_t inflate_some(void* to, std::size_t bytes) {
    std::size_t done = 0;
    while (done < bytes && !is_at_end) {
      refill();
      const uInt room = static_cast<uInt>(std::min<std::size_t>(bytes - done, std::size_t{1} << 30));
      stream.next_out = static_cast<Bytef*>(to) + done;
      stream.avail_out = room;
      const bool had_input = stream.avail_in > 0;
      const int result = inflate(&stream, Z_NO_FLUSH);
      done += room - stream.avail_out;
      if (result == Z_STREAM_END) {
        start_next_member();
      } else if (result == Z_BUF_ERROR && !had_input) {
        refuse_file(
            path, "image.truncated",
            fmt::format("is cut off: its compressed bytes end at byte {} of the file, after {} decoded bytes",
                        taken, position + done),
            "copy or download the file again");
      } else if (result != Z_OK && result != Z_BUF_ERROR) {
        refuse_file(
            path, "image.corrupt",
            fmt::format("has damaged compressed bytes near byte {} of the file ({})", taken - stream.avail_in,
                        stream.msg != nullptr ? stream.msg : "zlib gives no reason"),
            "copy or download the file again");
      }
    }
    return done;
  }
};

ByteSource::ByteSource(std::filesystem::path path, Coding coding, std::uint64_t file_offset)
    : state_(std::make_unique<State>()) {
  State& state = *state_;
  state.path = std::move(path);
  state.descriptor = ::open(state.path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  struct stat facts {};
  if (state.descriptor < 0 || ::fstat(state.descriptor, &facts) != 0) {
    throw Error(ErrorKind::kInput, errno == ENOENT ? "image.missing" : "image.unreadable",
                fmt::format("cannot open '{}': {}", state.path.string(), std::strerror(errno)),
                "check the path and your right to read it");
  }
  if (!S_ISREG(facts.st_mode)) refuse_file(state.path, "image.unreadable", "is not a regular file");
  state.file_bytes = static_cast<std::uint64_t>(facts.st_size);
  if (file_offset > state.file_bytes) {
    refuse_file(state.path, "image.truncated",
                fmt::format("has {} bytes, but its voxels are said to begin at byte {}", state.file_bytes,
                            file_offset));
  }
  std::array<unsigned char, 2> magic{};
  ::lseek(state.descriptor, static_cast<off_t>(file_offset), SEEK_SET);
  state.read_file(magic.data(), magic.size());
  ::lseek(state.descriptor, static_cast<off_t>(file_offset), SEEK_SET);
  state.taken = file_offset;

  const bool is_deflated = begins_as_gzip(magic) || (coding == Coding::kDeflated && begins_as_zlib(magic));
  if (coding == Coding::kDeflated && !is_deflated) {
    refuse_file(state.path, "image.corrupt",
                fmt::format("should hold gzip or zlib bytes at byte {}, but they begin with {:02x} {:02x}",
                            file_offset, magic[0], magic[1]),
                "if it is not compressed, name it without .gz");
  }
  state.is_compressed = coding != Coding::kPlain && is_deflated;
  if (!state.is_compressed) return;
  state.input.resize(kBufferBytes);
  if (inflateInit2(&state.stream, kGzipOrZlib) != Z_OK) {
    throw Error(ErrorKind::kLimit, "memory.exhausted", "zlib cannot allocate its tables");
  }
  state.has_stream = true;
}

ByteSource::~ByteSource() = default;

std::size_t ByteSource::read(void* to, std::size_t bytes) {
  const std::size_t got =
      state_->is_compressed ? state_->inflate_some(to, bytes) : state_->read_file(to, bytes);
  state_->position += got;
  return got;
}

void ByteSource::read_exactly(void* to, std::size_t bytes, std::string_view what) {
  const std::uint64_t begin = position();
  const std::size_t got = read(to, bytes);
  if (got == bytes) return;
  refuse_file(path(), "image.truncated",
              fmt::format("ends after {} of the {} bytes of its {} (at byte {}{})", got, bytes, what,
                          begin + got, is_compressed() ? " of the decoded content" : ""),
              "copy or download the file again");
}

void ByteSource::skip(std::uint64_t bytes, std::string_view what) {
  std::vector<char> sink(static_cast<std::size_t>(std::min<std::uint64_t>(bytes, kBufferBytes)));
  while (bytes > 0) {
    const std::size_t step = static_cast<std::size_t>(std::min<std::uint64_t>(bytes, sink.size()));
    read_exactly(sink.data(), step, what);
    bytes -= step;
  }
}

void ByteSource::check_rest(std::uint64_t limit) {
  if (!is_compressed()) return;
  std::vector<char> sink(kBufferBytes);
  for (std::uint64_t done = 0; done < limit;) {
    const std::size_t got = read(sink.data(), sink.size());
    if (got < sink.size()) return;
    done += got;
  }
}

std::uint64_t ByteSource::position() const {
  return state_->position;
}
std::uint64_t ByteSource::file_bytes() const {
  return state_->file_bytes;
}
bool ByteSource::is_compressed() const {
  return state_->is_compressed;
}
const std::filesystem::path& ByteSource::path() const {
  return state_->path;
}

std::uint64_t ByteSource::most_bytes_left() const {
  const std::uint64_t in_file = state_->file_bytes - std::min(state_->taken, state_->file_bytes);
  if (!is_compressed()) return in_file;
  // Bytes in the input buffer count; so do up to 32 KiB that the window may still hold back.
  return (in_file + state_->stream.avail_in) * kLargestRatio + (std::uint64_t{1} << 15);
}

}  // namespace periost
