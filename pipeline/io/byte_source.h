#pragma once
// Bytes of a file in order, inflated on the way when they are compressed. Nothing is ever allocated by a size
// that a file claims: callers compare the claim with most_bytes_left() and let their buffers grow with what
// arrives.
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace periost {

enum class Coding {
  kAuto,      // gzip when the bytes begin as gzip does, else plain
  kPlain,     //
  kDeflated,  // gzip or zlib, told apart by their first bytes; anything else is refused
};

// Every member throws Error{kInput}: "image.missing", "image.unreadable", "image.truncated", "image.corrupt".
class ByteSource {
 public:
  // Opens a regular file at byte `file_offset`; all of the rest is coded as `coding` says.
  explicit ByteSource(std::filesystem::path path, Coding coding = Coding::kAuto,
                      std::uint64_t file_offset = 0);
  ~ByteSource();
  ByteSource(const ByteSource&) = delete;
  ByteSource& operator=(const ByteSource&) = delete;

  // Reads up to `bytes`; fewer only where the content ends.
  std::size_t read(void* to, std::size_t bytes);
  // Reads all of them or throws "image.truncated", naming `what` was being read.
  void read_exactly(void* to, std::size_t bytes, std::string_view what);
  void skip(std::uint64_t bytes, std::string_view what);
  // Reads on to the end, at most `limit` bytes, so that the checksum of compressed bytes is verified.
  void check_rest(std::uint64_t limit);

  // Decoded bytes delivered so far.
  std::uint64_t position() const;
  // No more than this can follow: what is left of the file, times deflate's largest ratio when compressed.
  std::uint64_t most_bytes_left() const;
  std::uint64_t file_bytes() const;
  bool is_compressed() const;
  const std::filesystem::path& path() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// One sentence about a file, led by its name without the folders: folders can name a person.
[[noreturn]] void refuse_file(const std::filesystem::path& path, const std::string& code,
                              const std::string& text, const std::string& hint = {});

}  // namespace periost
