#pragma once
// The 128-bit xxh3 hash: names cache entries and pins artefacts in run.json. Not cryptographic.
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace periost {

// A running hash. Feed bytes in any cut: only their sequence counts.
class Hasher {
 public:
  Hasher();
  ~Hasher();
  Hasher(const Hasher&) = delete;
  Hasher& operator=(const Hasher&) = delete;

  Hasher& add(const void* data, std::size_t bytes);
  // Length first, so that ("ab","c") and ("a","bc") differ.
  Hasher& add(std::string_view text);
  // 32 lowercase hexadecimal digits.
  std::string hex() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// Hash of a file's content. Throws Error{kInput, "file.unreadable"}.
std::string hash_file(const std::filesystem::path& path);

}  // namespace periost
