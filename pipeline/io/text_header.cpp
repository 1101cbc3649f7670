#include "pipeline/io/text_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>

#include "pipeline/io/byte_source.h"

namespace periost {
namespace {

constexpr std::size_t kMostHeaderBytes = std::size_t{1} << 18;
constexpr std::string_view kSeparators = " \t,()";

[[noreturn]] void refuse_value(const std::filesystem::path& path, std::string_view key,
                               std::string_view value, std::size_t count) {
  refuse_file(path, "image.header",
              fmt::format("needs {} number{} for '{}' in its header, not '{}'", count, count == 1 ? "" : "s",
                          key, value.substr(0, 80)));
}

}  // namespace

std::string read_head(const std::filesystem::path& path) {
  ByteSource source(path, path.extension() == ".gz" ? Coding::kDeflated : Coding::kAuto);
  std::string head(kMostHeaderBytes, '\0');
  head.resize(source.read(head.data(), head.size()));
  return head;
}

bool next_line(std::string_view text, std::size_t& at, std::string_view& line) {
  const std::size_t end = text.find('\n', at);
  if (end == std::string_view::npos) return false;
  line = text.substr(at, end - at);
  if (line.ends_with('\r')) line.remove_suffix(1);
  at = end + 1;
  return true;
}

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

std::string lower_case(std::string_view text) {
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  return lower;
}

std::vector<double> numbers_in(const std::filesystem::path& path, std::string_view key,
                               std::string_view value, std::size_t count) {
  std::vector<double> numbers;
  for (std::size_t at = 0; (at = value.find_first_not_of(kSeparators, at)) != std::string_view::npos;) {
    std::string_view word = value.substr(at, value.find_first_of(kSeparators, at) - at);
    at += word.size();
    if (word.starts_with('+')) word.remove_prefix(1);
    double number = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (error != std::errc() || end != word.data() + word.size() || numbers.size() == count) {
      refuse_value(path, key, value, count);
    }
    numbers.push_back(number);
  }
  if (numbers.size() != count) refuse_value(path, key, value, count);
  return numbers;
}

std::vector<std::int64_t> integers_in(const std::filesystem::path& path, std::string_view key,
                                      std::string_view value, std::size_t count) {
  std::vector<std::int64_t> integers;
  for (const double number : numbers_in(path, key, value, count)) {
    if (!(std::abs(number) < 9e15) || number != std::floor(number)) refuse_value(path, key, value, count);
    integers.push_back(static_cast<std::int64_t>(number));
  }
  return integers;
}

}  // namespace periost
