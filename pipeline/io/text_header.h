#pragma once
// What the formats with a text header share: lines, names and numbers.
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace periost {

// The first decoded bytes of a file, enough for any sensible header (at most 256 KiB).
std::string read_head(const std::filesystem::path& path);

// Takes the next line of `text` from `at` on, without its LF or CR LF; false when no whole line is left.
bool next_line(std::string_view text, std::size_t& at, std::string_view& line);

std::string_view trimmed(std::string_view text);
std::string lower_case(std::string_view text);

// All numbers of a value such as "1 2 3" or "(1,0,0) (0,1,0)"; throws "image.header" unless there are
// `count`.
std::vector<double> numbers_in(const std::filesystem::path& path, std::string_view key,
                               std::string_view value, std::size_t count);
// The same for whole numbers.
std::vector<std::int64_t> integers_in(const std::filesystem::path& path, std::string_view key,
                                      std::string_view value, std::size_t count);

}  // namespace periost
