#pragma once
// Small image files put together byte by byte, independent of our writers.
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/base/error.h"
#include "pipeline/io/image_read.h"

namespace periost::test {

// A folder that vanishes with the object.
class Folder {
 public:
  Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "periost-image-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    path_ = name;
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  std::filesystem::path write(const std::string& name, const std::string& bytes) const {
    std::filesystem::create_directories((path_ / name).parent_path());
    // A new file: rewriting one makes some file systems wait for the disk.
    std::filesystem::remove(path_ / name);
    std::ofstream(path_ / name, std::ios::binary) << bytes;
    return path_ / name;
  }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

inline std::string read_bytes(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

template <class T>
std::string bytes_of_value(T value, bool is_big_endian = false) {
  auto raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
  if (is_big_endian) std::reverse(raw.begin(), raw.end());
  return {raw.begin(), raw.end()};
}

template <class T>
std::string bytes_of_values(const std::vector<T>& values, bool is_big_endian = false) {
  std::string bytes;
  for (const T value : values) bytes += bytes_of_value(value, is_big_endian);
  return bytes;
}

template <class T>
void put(std::string& bytes, std::size_t offset, T value, bool is_big_endian = false) {
  const std::string raw = bytes_of_value(value, is_big_endian);
  std::copy(raw.begin(), raw.end(), bytes.begin() + static_cast<std::ptrdiff_t>(offset));
}

inline void put_text(std::string& bytes, std::size_t offset, std::string_view text) {
  std::copy(text.begin(), text.end(), bytes.begin() + static_cast<std::ptrdiff_t>(offset));
}

// window_bits: 31 for gzip, 15 for zlib.
inline std::string deflated(const std::string& bytes, int window_bits = 31) {
  z_stream stream{};
  deflateInit2(&stream, 6, Z_DEFLATED, window_bits, 8, Z_DEFAULT_STRATEGY);
  std::string out(bytes.size() + bytes.size() / 100 + 100, '\0');
  std::string in = bytes;
  stream.next_in = reinterpret_cast<Bytef*>(in.data());
  stream.avail_in = static_cast<uInt>(in.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  deflate(&stream, Z_FINISH);
  out.resize(out.size() - stream.avail_out);
  deflateEnd(&stream);
  return out;
}

// A tar entry with header and padding.
inline std::string tar_entry(const std::string& name, const std::string& content, char kind = '0') {
  std::string header(512, '\0');
  put_text(header, 0, name);
  put_text(header, 100, "0000644");
  std::array<char, 12> size{};
  std::snprintf(size.data(), size.size(), "%011zo", content.size());
  put_text(header, 124, {size.data(), 11});
  header[156] = kind;
  put_text(header, 148, "        ");
  unsigned sum = 0;
  for (const char letter : header) sum += static_cast<unsigned char>(letter);
  std::snprintf(size.data(), size.size(), "%06o", sum);
  put_text(header, 148, {size.data(), 6});
  header[154] = '\0';
  return header + content + std::string((512 - content.size() % 512) % 512, '\0');
}

// A NIfTI-1 header of 352 bytes for 2 x 3 x 4 voxels of int16, spacing 1 x 2 x 3 mm, without orientation.
inline std::string nifti1(bool big = false) {
  std::string h(352, '\0');
  put(h, 0, std::int32_t{348}, big);
  const std::array<std::int16_t, 8> dim{3, 2, 3, 4, 1, 1, 1, 1};
  for (std::size_t n = 0; n < 8; ++n) put(h, 40 + 2 * n, dim[n], big);
  put(h, 70, std::int16_t{4}, big);
  put(h, 72, std::int16_t{16}, big);
  const std::array<float, 4> pixdim{1, 1, 2, 3};
  for (std::size_t n = 0; n < 4; ++n) put(h, 76 + 4 * n, pixdim[n], big);
  put(h, 108, 352.0F, big);
  put_text(h, 344, "n+1");
  return h;
}

// 24 voxels: 0, 1, 2, ...
template <class T>
std::vector<T> counting() {
  std::vector<T> values(24);
  for (std::size_t n = 0; n < values.size(); ++n) values[n] = static_cast<T>(n);
  return values;
}

// The code of the error that reading throws, or "" when the file is read.
inline std::string refusal(const std::filesystem::path& path, const ImageFileOptions& options = {}) {
  try {
    read_image(path, options);
  } catch (const Error& error) {
    return error.kind() == ErrorKind::kInput ? error.code() : "wrong kind: " + error.code();
  }
  return {};
}

}  // namespace periost::test
