#include "pipeline/base/file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>
#include <utility>

#include "pipeline/base/error.h"

namespace periost {
namespace {

constexpr std::size_t kBufferBytes = std::size_t{1} << 20;

}  // namespace

std::filesystem::path partial_path(const std::filesystem::path& path) {
  // The extension stays last, since some writers choose their format by it.
  std::filesystem::path partial = path;
  partial.replace_filename("." + path.stem().string() + ".partial" + path.extension().string());
  return partial;
}

void commit_partial(const std::filesystem::path& path) {
  std::error_code error;
  std::filesystem::rename(partial_path(path), path, error);
  if (!error) return;
  std::error_code ignored;
  std::filesystem::remove(partial_path(path), ignored);
  throw Error(ErrorKind::kLimit, "file.unwritable",
              fmt::format("cannot put '{}' in place: {}", path.string(), error.message()));
}

AtomicFile::AtomicFile(std::filesystem::path path) : path_(std::move(path)), partial_(partial_path(path_)) {
  std::error_code ignored;
  if (path_.has_parent_path()) std::filesystem::create_directories(path_.parent_path(), ignored);
  descriptor_ = ::open(partial_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor_ < 0) fail("open");
  buffer_.reserve(kBufferBytes);
}

AtomicFile::~AtomicFile() {
  if (descriptor_ < 0) return;
  ::close(descriptor_);
  std::error_code ignored;
  std::filesystem::remove(partial_, ignored);
}

void AtomicFile::fail(const char* action) const {
  const int reason = errno;
  const bool is_full = reason == ENOSPC || reason == EFBIG || reason == EDQUOT;
  throw Error(ErrorKind::kLimit, is_full ? "file.disk_full" : "file.unwritable",
              fmt::format("cannot {} '{}': {}", action, path_.string(), std::strerror(reason)),
              is_full ? "free some space or choose another folder with --out"
                      : "check that the folder exists and that you may write to it");
}

void AtomicFile::flush() {
  std::size_t done = 0;
  while (done < buffer_.size()) {
    const ssize_t written = ::write(descriptor_, buffer_.data() + done, buffer_.size() - done);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail("write");
    done += static_cast<std::size_t>(written);
  }
  buffer_.clear();
}

void AtomicFile::write(const void* data, std::size_t bytes) {
  buffer_.append(static_cast<const char*>(data), bytes);
  if (buffer_.size() >= kBufferBytes) flush();
}

void AtomicFile::commit() {
  flush();
  // Data reaches the disk before the name does, so a crash cannot leave an empty file under the final name.
  if (::fsync(descriptor_) != 0 && errno != EINVAL) fail("write");
  const int descriptor = std::exchange(descriptor_, -1);
  if (::close(descriptor) != 0) fail("close");
  commit_partial(path_);
}

std::string read_text(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  if (!file || !(text << file.rdbuf())) {
    // An empty file makes the stream fail as well, but has been opened.
    if (file.is_open() && std::filesystem::is_regular_file(path)) return {};
    throw Error(ErrorKind::kInput, "file.unreadable", fmt::format("cannot read '{}'", path.string()),
                "check that it exists and that you may read it");
  }
  return text.str();
}

}  // namespace periost
