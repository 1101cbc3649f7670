#pragma once
// A file of Gmsh's as a row of section names and numbers, whichever way its numbers are written.
#include <cstdint>
#include <filesystem>
#include <string>

#include "pipeline/io/text_scanner.h"

namespace periost {

// Sections are "$Name ... $EndName" in every version. Versions 2 and 4.1 have the same numbers in the same
// row in text and in binary, but for what read_elements_2 in gmsh_read.cpp says, so that a reader asks for
// the next number and need not know which it is. All members throw Error{kInput} with the place:
// "mesh.malformed", "mesh.truncated", "mesh.unsupported", "mesh.bad_index".
class GmshFile {
 public:
  // Reads the whole file. Throws Error{kInput, "file.unreadable"}.
  explicit GmshFile(const std::filesystem::path& path);
  GmshFile(const GmshFile&) = delete;
  GmshFile& operator=(const GmshFile&) = delete;

  bool is_text() const { return encoding_ == Encoding::kText; }
  // "femur.msh:17", or "femur.msh: byte 4711" in a binary file.
  std::string place() const;
  [[noreturn]] void fail(const char* code, const std::string& what) const;

  // The name of the next section without its '$'; empty at the end of the file.
  std::string next_section();
  void expect_end(const std::string& section);
  void skip_section(const std::string& section);
  // What stands in $MeshFormat: returns the version and remembers how numbers are written.
  double read_format();

  // How many things follow, checked against what the rest of the file can hold: each takes two bytes at
  // least.
  std::uint64_t count();
  // The same, where it stands as text in binary files, too (version 2).
  std::uint64_t text_count();
  // One number: of 8 bytes, of 4 bytes, a coordinate.
  std::uint64_t size();
  std::int64_t integer();
  double decimal();
  // The number of a node or element where these have 4 bytes (version 2).
  std::uint64_t short_number();

 private:
  enum class Encoding { kText, kBinary, kSwapped };

  [[noreturn]] void fail_truncated(const std::string& what) const;
  void end_line();
  std::uint64_t checked(std::uint64_t count) const;
  template <class T>
  T text_number(const char* what);
  template <class T>
  T bytes_as();

  std::filesystem::path path_;
  std::string text_;
  TextScanner scanner_;
  Encoding encoding_ = Encoding::kText;
};

}  // namespace periost
