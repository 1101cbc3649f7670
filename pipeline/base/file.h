#pragma once
// Files that appear whole or not at all: written to `NAME.partial` in the same folder, then renamed.
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace periost {

class AtomicFile {
 public:
  // Creates the folder if need be and opens `path`.partial. Throws Error{kLimit, "file.unwritable"}.
  explicit AtomicFile(std::filesystem::path path);
  // Without commit() the partial file is removed and `path` stays as it was.
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  // Throws Error{kLimit, "file.disk_full"} when bytes cannot be written, naming file and free space.
  void write(const void* data, std::size_t bytes);
  void write(std::string_view text) { write(text.data(), text.size()); }
  // Flushes, closes and renames into place.
  void commit();

 private:
  [[noreturn]] void fail(const char* action) const;
  void flush();
  std::filesystem::path path_;
  std::filesystem::path partial_;
  int descriptor_ = -1;
  std::string buffer_;
};

// The temporary name for writers that open files themselves (VTK): write there, then call commit_partial.
std::filesystem::path partial_path(const std::filesystem::path& path);
// Renames partial_path(path) to path. Throws Error{kLimit, "file.unwritable"}; the partial is removed on
// failure.
void commit_partial(const std::filesystem::path& path);

// The whole content of a file. Throws Error{kInput, "file.unreadable"}.
std::string read_text(const std::filesystem::path& path);

}  // namespace periost
