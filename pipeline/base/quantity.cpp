#include "pipeline/base/quantity.h"

#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <utility>

namespace periost {
namespace {

// Splits "0.3 voxel" into its number and its unit; the unit may be empty.
std::optional<std::pair<double, std::string_view>> split(std::string_view text) {
  std::size_t end = 0;
  while (end < text.size() && std::string_view("+-.0123456789").find(text[end]) != std::string_view::npos)
    ++end;
  // An exponent belongs to the number only if digits follow it ("1e3", but not the "e" of a unit).
  if (end < text.size() && (text[end] == 'e' || text[end] == 'E')) {
    std::size_t exponent = end + 1;
    if (exponent < text.size() && (text[exponent] == '-' || text[exponent] == '+')) ++exponent;
    const std::size_t digits = exponent;
    while (exponent < text.size() && text[exponent] >= '0' && text[exponent] <= '9') ++exponent;
    if (exponent > digits) end = exponent;
  }
  const std::optional<double> number = parse_number(text.substr(0, end));
  if (!number) return std::nullopt;
  if (end < text.size() && text[end] == ' ') ++end;
  return std::pair{*number, text.substr(end)};
}

}  // namespace

std::optional<double> parse_number(std::string_view text) {
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  std::string_view digits = text;
  if (!digits.empty() && digits.front() == '-') digits.remove_prefix(1);
  if (digits.empty() || (digits.front() != '.' && (digits.front() < '0' || digits.front() > '9'))) {
    return std::nullopt;  // also refuses nan and inf
  }
  if (digits.size() > 1 && digits[0] == '0' && digits[1] >= '0' && digits[1] <= '9') return std::nullopt;
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::optional<Length> parse_length(std::string_view text) {
  const auto parts = split(text);
  if (!parts) return std::nullopt;
  const auto [value, unit] = *parts;
  if (unit.empty() || unit == "mm") return Length::mm(value);
  if (unit == "voxel" || unit == "voxels") return Length::voxel(value);
  if (unit == "um") return Length::mm(value * 1e-3);
  if (unit == "cm") return Length::mm(value * 10);
  if (unit == "m") return Length::mm(value * 1000);
  return std::nullopt;
}

std::optional<Angle> parse_angle(std::string_view text) {
  const auto parts = split(text);
  if (!parts) return std::nullopt;
  const auto [value, unit] = *parts;
  if (unit.empty() || unit == "deg") return Angle::deg(value);
  if (unit == "rad") return Angle::deg(value * 57.29577951308232);
  return std::nullopt;
}

std::optional<ByteSize> parse_byte_size(std::string_view text) {
  struct Unit {
    std::string_view name;
    double factor;
  };
  static constexpr std::array<Unit, 9> kUnits{{{"B", 1},
                                               {"kB", 1e3},
                                               {"MB", 1e6},
                                               {"GB", 1e9},
                                               {"TB", 1e12},
                                               {"KiB", 1024.0},
                                               {"MiB", 1048576.0},
                                               {"GiB", 1073741824.0},
                                               {"TiB", 1099511627776.0}}};
  const auto parts = split(text);
  if (!parts || parts->first < 0) return std::nullopt;
  for (const Unit& unit : kUnits) {
    if (parts->second != unit.name) continue;
    const double bytes = parts->first * unit.factor;
    if (bytes >= 9e18) return std::nullopt;
    return ByteSize{static_cast<std::uint64_t>(std::llround(bytes))};
  }
  return std::nullopt;
}

std::string to_text(double value) {
  std::array<char, 32> buffer{};
  const auto [end, error] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return error == std::errc{} ? std::string(buffer.data(), end) : std::string("nan");
}

std::string to_text(const Length& length) {
  return to_text(length.value) + (length.unit == Length::Unit::kVoxel ? " voxel" : " mm");
}

std::string to_text(const Angle& angle) {
  return to_text(angle.degrees) + " deg";
}

std::string to_text(const ByteSize& size) {
  if (size.bytes != 0 && size.bytes % kMiB == 0) return std::to_string(size.bytes / kMiB) + "MiB";
  return std::to_string(size.bytes) + "B";
}

std::string mebibytes(std::uint64_t bytes) {
  return std::to_string((bytes + kMiB / 2) / kMiB) + " MiB";
}

}  // namespace periost
