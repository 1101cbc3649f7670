// A project of InVesalius 3: a tar, gzipped or not, with one top folder; main.plist describes matrix.dat, the
// grey values. Nothing is unpacked to the disk: the voxels are read where they lie in the decoded stream, and
// names of entries are only compared. The project's `name` may be a person's and is never looked at.
#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <map>
#include <stdexcept>

#include "pipeline/base/quantity.h"
#include "pipeline/io/image_layout.h"
#include "pipeline/io/plist.h"

namespace periost {
namespace {

constexpr std::size_t kBlock = 512;
constexpr std::uint64_t kMostPlistBytes = 1 << 20;
constexpr int kMostEntries = 10000;

struct TarEntry {
  std::string name;  // below the top folder
  std::uint64_t bytes = 0;
  std::uint64_t begin = 0;  // in the decoded stream
};

// An octal number of a tar header; blanks and NULs around it are allowed.
std::uint64_t octal(const std::filesystem::path& path, std::string_view field, std::uint64_t at) {
  const std::size_t first = field.find_first_not_of(' ');
  const std::string_view digits =
      first == std::string_view::npos
          ? ""
          : field.substr(first, field.find_first_of(std::string_view(" \0", 2), first) - first);
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value, 8);
  if (digits.empty() || error != std::errc() || end != digits.data() + digits.size()) {
    refuse_file(path, "image.header",
                fmt::format("has a broken tar header at byte {} of its decoded content", at));
  }
  return value;
}

void check_sum(const std::filesystem::path& path, std::string_view header, std::uint64_t at) {
  std::uint64_t sum = 0;
  for (std::size_t n = 0; n < kBlock; ++n) {
    sum += n >= 148 && n < 156 ? ' ' : static_cast<unsigned char>(header[n]);
  }
  if (sum != octal(path, header.substr(148, 8), at)) {
    refuse_file(
        path, "image.header",
        fmt::format("is not an InVesalius project: no tar header at byte {} of its decoded content", at));
  }
}

std::string name_below_top(std::string_view header) {
  std::string_view name = header.substr(0, 100);
  name = name.substr(0, name.find('\0'));
  if (name.starts_with("./")) name.remove_prefix(2);
  const std::size_t slash = name.find('/');
  return std::string(slash == std::string_view::npos ? name : name.substr(slash + 1));
}

// The next entry, or nothing at the end of the archive. Afterwards the source stands at the entry's first
// byte.
bool next_entry(ByteSource& source, TarEntry& entry) {
  std::array<char, kBlock> block{};
  const std::uint64_t at = source.position();
  if (source.read(block.data(), kBlock) < kBlock) return false;
  const std::string_view header(block.data(), kBlock);
  if (header.find_first_not_of('\0') == std::string_view::npos) return false;
  check_sum(source.path(), header, at);
  const char kind = header[156];
  const bool is_file = kind == '0' || kind == '\0';
  entry = {is_file ? name_below_top(header) : std::string(), octal(source.path(), header.substr(124, 12), at),
           source.position()};
  if (entry.bytes > source.most_bytes_left()) {
    refuse_file(
        source.path(), "image.truncated",
        fmt::format("holds an entry of {} bytes at byte {}, more than the archive can", entry.bytes, at));
  }
  return true;
}

std::uint64_t padded(std::uint64_t bytes) {
  return (bytes + kBlock - 1) / kBlock * kBlock;
}

const PlistNode& need(const std::filesystem::path& path, const PlistNode& dict, std::string_view key) {
  const PlistNode* node = dict.find(key);
  if (node == nullptr) refuse_file(path, "image.header", fmt::format("lacks '{}' in its main.plist", key));
  return *node;
}

std::array<double, 3> three_numbers(const std::filesystem::path& path, const PlistNode& node,
                                    std::string_view key) {
  std::array<double, 3> numbers{};
  for (std::size_t n = 0; n < 3; ++n) {
    const auto number = node.items.size() == 3 ? parse_number(node.items[n].text) : std::nullopt;
    if (!number)
      refuse_file(path, "image.header", fmt::format("needs three numbers for '{}' in its main.plist", key));
    numbers[n] = *number;
  }
  return numbers;
}

std::array<std::int32_t, 3> dims_of_shape(const std::filesystem::path& path,
                                          const std::array<double, 3>& shape) {
  std::array<std::int64_t, 3> dims{};
  for (std::size_t n = 0; n < 3; ++n) {
    const double size = shape[2 - n];
    dims[n] = std::abs(size) < 1e15 && size == std::floor(size) ? static_cast<std::int64_t>(size) : -1;
  }
  return checked_dims(path, dims);
}

struct Matrix {
  std::string file;
  ImageLayout layout;
};

Matrix matrix_of(const std::filesystem::path& path, const std::string& xml) {
  PlistNode plist;
  try {
    plist = parse_plist(xml);
  } catch (const std::runtime_error& error) {
    refuse_file(path, "image.header", fmt::format("has a broken main.plist: {}", error.what()));
  }
  const PlistNode& matrix = need(path, plist, "matrix");
  Matrix result;
  result.file = need(path, matrix, "filename").text;
  ImageLayout& layout = result.layout;
  layout.type = voxel_type_from_name(path, need(path, matrix, "dtype").text);
  const auto dims = dims_of_shape(path, three_numbers(path, need(path, matrix, "shape"), "shape"));
  const auto spacing = three_numbers(path, need(path, plist, "spacing"), "spacing");
  // Rows grow to anterior and slices to superior.
  layout.frame = frame_from_steps(
      path, dims, {Vec3{spacing[0], 0, 0}, Vec3{0, -spacing[1], 0}, Vec3{0, 0, spacing[2]}}, Vec3{});
  layout.data_file = path;
  layout.format = "InVesalius";
  layout.notes.emplace_back("an InVesalius project states no orientation: axes L A S and origin 0 assumed");
  return result;
}

}  // namespace

ImageLayout inv3_layout(const std::filesystem::path& path) {
  ByteSource source(path);
  std::map<std::string, TarEntry> entries;
  std::string xml;
  TarEntry entry;
  for (int count = 0; count < kMostEntries && next_entry(source, entry); ++count) {
    entries.insert_or_assign(entry.name, entry);
    std::uint64_t left = padded(entry.bytes);
    if (entry.name == "main.plist") {
      if (entry.bytes > kMostPlistBytes) refuse_file(path, "image.header", "has a main.plist of over 1 MiB");
      xml.resize(static_cast<std::size_t>(entry.bytes));
      source.read_exactly(xml.data(), xml.size(), "main.plist");
      left -= entry.bytes;
    }
    if (!xml.empty()) {
      Matrix matrix = matrix_of(path, xml);
      const auto found = entries.find(matrix.file);
      if (found != entries.end()) {
        const std::uint64_t wanted = matrix.layout.frame.voxel_count() * bytes_of(matrix.layout.type);
        if (found->second.bytes != wanted) {
          refuse_file(
              path, "image.truncated",
              fmt::format("says that {} x {} x {} voxels of {} are in '{}', which has {} bytes instead of {}",
                          matrix.layout.frame.dims[0], matrix.layout.frame.dims[1],
                          matrix.layout.frame.dims[2], name_of(matrix.layout.type), matrix.file,
                          found->second.bytes, wanted));
        }
        matrix.layout.decoded_offset = found->second.begin;
        return matrix.layout;
      }
    }
    source.skip(left, "archive");
  }
  refuse_file(path, "image.header",
              xml.empty() ? "is not an InVesalius project: it has no main.plist"
                          : "lacks the matrix that its main.plist names");
}

}  // namespace periost
