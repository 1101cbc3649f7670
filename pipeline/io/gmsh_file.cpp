#include "pipeline/io/gmsh_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "pipeline/base/file.h"
#include "pipeline/io/mesh_builder.h"

namespace periost {

GmshFile::GmshFile(const std::filesystem::path& path)
    : path_(path), text_(read_text(path)), scanner_(text_) {}

std::string GmshFile::place() const {
  if (is_text()) return fmt::format("{}:{}", path_.string(), scanner_.line());
  return fmt::format("{}: byte {}", path_.string(), text_.size() - scanner_.bytes_left());
}

void GmshFile::fail(const char* code, const std::string& what) const {
  refuse_mesh(code, place(), what);
}

void GmshFile::fail_truncated(const std::string& what) const {
  refuse_mesh("mesh.truncated", place(), what, "copy or export the file again: its end is missing");
}

// Binary data begin right behind the line break.
void GmshFile::end_line() {
  scanner_.skip_line();
  if (scanner_.bytes_left() > 0) scanner_.skip(1);
}

std::string GmshFile::next_section() {
  const std::string_view word = scanner_.word();
  if (word.empty()) return {};
  if (word[0] != '$') {
    fail("mesh.malformed", fmt::format("'{}' stands where a section should begin", printable(word)));
  }
  end_line();
  return std::string(word.substr(1));
}

void GmshFile::expect_end(const std::string& section) {
  const std::string_view word = scanner_.word();
  if (word.empty()) fail_truncated(fmt::format("it ends within ${}", printable(section)));
  if (word.substr(0, 1) != "$" || word.substr(1) != "End" + section) {
    fail("mesh.malformed",
         fmt::format("${0} holds more than it announces, or has no $End{0}", printable(section)));
  }
}

void GmshFile::skip_section(const std::string& section) {
  const std::size_t at = scanner_.rest().find("$End" + section);
  if (at == std::string_view::npos) fail_truncated(fmt::format("${} has no end", printable(section)));
  scanner_.skip(at);
  expect_end(section);
}

double GmshFile::read_format() {
  double version = 0;
  int is_binary = 0, size = 0;
  if (!scanner_.number(version) || !scanner_.number(is_binary) || !scanner_.number(size)) {
    fail("mesh.malformed", "$MeshFormat needs a version, 0 or 1 for binary, and a size");
  }
  if (is_binary != 0) {
    if (size != 8) {
      refuse_mesh("mesh.unsupported", place(), fmt::format("its numbers have {} bytes", size),
                  "save it with 8 bytes");
    }
    end_line();
    encoding_ = Encoding::kBinary;
    if (const std::int64_t one = integer(); one == 0x01000000) {
      encoding_ = Encoding::kSwapped;
    } else if (one != 1) {
      fail("mesh.malformed", "the number that tells the byte order is not 1");
    }
  }
  expect_end("MeshFormat");
  return version;
}

std::uint64_t GmshFile::checked(std::uint64_t count) const {
  if (count > scanner_.bytes_left() / 2) {
    fail_truncated(fmt::format("a count of {} is more than the rest of the file can hold", count));
  }
  return count;
}

template <class T>
T GmshFile::text_number(const char* what) {
  T value{};
  TextScanner before = scanner_;
  if (scanner_.number(value)) return value;
  const std::string_view word = before.word();
  if (word.empty()) fail_truncated(fmt::format("it ends where {} should follow", what));
  fail("mesh.malformed", fmt::format("'{}' is not {}", printable(word), what));
}

template <class T>
T GmshFile::bytes_as() {
  std::array<char, sizeof(T)> bytes;
  if (scanner_.bytes_left() < bytes.size()) fail_truncated("it ends within the data");
  std::memcpy(bytes.data(), scanner_.rest().data(), bytes.size());
  if (encoding_ == Encoding::kSwapped) std::reverse(bytes.begin(), bytes.end());
  scanner_.skip(bytes.size());
  T value;
  std::memcpy(&value, bytes.data(), sizeof value);
  return value;
}

std::uint64_t GmshFile::count() {
  return checked(size());
}

std::uint64_t GmshFile::text_count() {
  const std::uint64_t value = checked(text_number<std::uint64_t>("a count"));
  end_line();
  return value;
}

std::uint64_t GmshFile::size() {
  return is_text() ? text_number<std::uint64_t>("a whole number") : bytes_as<std::uint64_t>();
}

std::int64_t GmshFile::integer() {
  return is_text() ? text_number<std::int64_t>("a whole number") : bytes_as<std::int32_t>();
}

double GmshFile::decimal() {
  return is_text() ? text_number<double>("a coordinate") : bytes_as<double>();
}

std::uint64_t GmshFile::short_number() {
  const std::int64_t value = integer();
  if (value < 0) fail("mesh.bad_index", fmt::format("{} is not a number of a node or element", value));
  return static_cast<std::uint64_t>(value);
}

}  // namespace periost
