#include "pipeline/param/scalar_codec.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>

#include "pipeline/param/render.h"

namespace periost {
namespace {

using Kind = Value::Kind;

std::string shown(const Value& value) {
  switch (value.kind) {
    case Kind::kNull:
      return "nothing";
    case Kind::kScalar:
      return "'" + value.text + "'";
    case Kind::kList:
      return "a list";
    case Kind::kMap:
      return "a map";
  }
  return {};
}

bool wrong_type(const Value& value, const CodecScope& scope, const std::string& wanted,
                std::string hint = {}) {
  const std::string text = value.kind == Kind::kNull ? fmt::format("there is no value; it must be {}", wanted)
                                                     : fmt::format("{} is not {}", shown(value), wanted);
  return scope.error("config.wrong_type", value, text, std::move(hint));
}

bool in_range(double number, const Value& value, const CodecScope& scope) {
  if (scope.range.contains(number)) return true;
  return scope.error("config.out_of_range", value, fmt::format("{} is out of range", shown(value)),
                     "it must be " + scope.range.text());
}

// What may follow a number, by quantity of a plain `double`; the first is written back.
struct Unit {
  std::string_view name;
  double factor;
};
std::vector<Unit> units_of(Quantity quantity) {
  switch (quantity) {
    case Quantity::kLength:
      return {{"mm", 1}, {"um", 1e-3}, {"cm", 10}, {"m", 1000}};
    case Quantity::kAngle:
      return {{"deg", 1}, {"rad", 57.29577951308232}};
    case Quantity::kIntensity:
      return {{"", 1}, {"HU", 1}};
    case Quantity::kVolume:
      return {{"mm3", 1}, {"mm^3", 1}, {"cm3", 1000}, {"cm^3", 1000}, {"ml", 1000}};
    case Quantity::kSeconds:
      return {{"s", 1}, {"ms", 1e-3}, {"min", 60}, {"h", 3600}};
    default:
      return {};
  }
}

struct NumberAndUnit {
  double number = 0;
  std::string_view unit;
};

// The longest start of the text that is a number, and the rest of it as its unit.
std::optional<NumberAndUnit> split(std::string_view text) {
  for (std::size_t end = text.size(); end > 0; --end) {
    const std::optional<double> number = parse_number(text.substr(0, end));
    if (!number) continue;
    std::string_view unit = text.substr(end);
    const bool starts_with_digit = !unit.empty() && unit[0] >= '0' && unit[0] <= '9';
    if (starts_with_digit) return std::nullopt;  // a leading zero, as in 010
    if (!unit.empty() && unit[0] == ' ') unit.remove_prefix(1);
    return NumberAndUnit{*number, unit};
  }
  return std::nullopt;
}

// A bare number in quotes is a text: the writer of "3" meant a name.
bool is_quoted_number(const Value& value) {
  return value.is_quoted && parse_number(value.text).has_value();
}

bool unit_error(const Value& value, const CodecScope& scope, const std::string& wanted,
                const std::string& units, const std::string& example) {
  const std::string hint = "write it like " + example;
  const auto parts = value.kind == Kind::kScalar ? split(value.text) : std::nullopt;
  if (!parts || is_quoted_number(value)) return wrong_type(value, scope, wanted, hint);
  const std::string unit =
      parts->unit.empty() ? "has no unit" : fmt::format("has a unit that is not one of {}", units);
  return scope.error("config.wrong_unit", value, fmt::format("{} {}", shown(value), unit), hint);
}

template <class T, class Parse>
bool decode_quantity(const Value& value, const CodecScope& scope, T& out, Parse parse,
                     double (*number_of)(const T&), const std::string& wanted, const std::string& units,
                     const std::string& example) {
  const std::optional<T> parsed =
      value.kind == Kind::kScalar && !is_quoted_number(value) ? parse(value.text) : std::nullopt;
  if (!parsed) return unit_error(value, scope, wanted, units, example);
  out = *parsed;
  return in_range(number_of(out), value, scope);
}

template <class T>
std::optional<T> parse_integer(std::string_view text) {
  T number = 0;
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return number;
}

}  // namespace

CodecScope CodecScope::at(const std::string& sub_key) const {
  CodecScope scope = *this;
  scope.key = key.empty() ? sub_key : key + "." + sub_key;
  return scope;
}

CodecScope CodecScope::at(std::size_t index) const {
  CodecScope scope = *this;
  scope.key += fmt::format("[{}]", index);
  return scope;
}

bool CodecScope::error(const char* code, const Value& at, std::string text, std::string hint) const {
  std::string sentence = key.empty() ? std::move(text) : fmt::format("key '{}': {}", key, text);
  diagnostics->push_back({Severity::kError, code, {}, key, at.place, std::move(sentence), std::move(hint)});
  return false;
}

bool decode_scalar(const Value& value, const CodecScope& scope, bool& out) {
  const bool is_word = value.kind == Kind::kScalar && !value.is_quoted;
  out = is_word && value.text == "true";
  if (out || (is_word && value.text == "false")) return true;
  return wrong_type(value, scope, "a switch", "write true or false");
}

bool decode_scalar(const Value& value, const CodecScope& scope, std::int64_t least, std::uint64_t largest,
                   std::int64_t& out) {
  const bool is_plain = value.kind == Kind::kScalar && !value.is_quoted;
  const std::optional<double> number = is_plain ? parse_number(value.text) : std::nullopt;
  if (!number || *number != std::floor(*number)) return wrong_type(value, scope, "a whole number");
  if (!in_range(*number, value, scope)) return false;
  const bool fits = *number >= static_cast<double>(least) && *number <= static_cast<double>(largest);
  // Digits are read exactly; only a form like 1e6 goes through the double.
  const auto exact = parse_integer<std::int64_t>(value.text);
  if (!fits || (!exact && std::abs(*number) > 9007199254740992.0)) {
    return scope.error("config.out_of_range", value, fmt::format("{} is out of range", shown(value)),
                       fmt::format("it must be from {} to {}", least, largest));
  }
  out = exact ? *exact : static_cast<std::int64_t>(*number);
  return true;
}

bool decode_scalar(const Value& value, const CodecScope& scope, std::uint64_t& out) {
  const bool is_plain = value.kind == Kind::kScalar && !value.is_quoted;
  const std::optional<double> number = is_plain ? parse_number(value.text) : std::nullopt;
  if (!number || *number != std::floor(*number)) return wrong_type(value, scope, "a whole number");
  if (!in_range(*number, value, scope)) return false;
  const auto exact = parse_integer<std::uint64_t>(value.text);
  if (*number < 0 || (!exact && *number > 9007199254740992.0)) {
    return scope.error("config.out_of_range", value, fmt::format("{} is out of range", shown(value)),
                       "it must be from 0 to 18446744073709551615");
  }
  out = exact ? *exact : static_cast<std::uint64_t>(*number);
  return true;
}

bool decode_scalar(const Value& value, const CodecScope& scope, double& out) {
  const std::vector<Unit> units = units_of(scope.quantity);
  const auto parts =
      value.kind == Kind::kScalar && !is_quoted_number(value) ? split(value.text) : std::nullopt;
  if (!parts) return wrong_type(value, scope, "a number");
  out = parts->number;
  if (!parts->unit.empty()) {
    const auto unit =
        std::find_if(units.begin(), units.end(), [&](const Unit& u) { return u.name == parts->unit; });
    if (unit == units.end()) {
      std::string names;
      for (const Unit& u : units) {
        if (!u.name.empty()) names += (names.empty() ? "" : ", ") + std::string(u.name);
      }
      return scope.error("config.wrong_unit", value,
                         fmt::format("{} has a unit that does not fit here", shown(value)),
                         names.empty() ? "it takes a number without a unit" : "it takes " + names);
    }
    out *= unit->factor;
  }
  return in_range(out, value, scope);
}

bool decode_scalar(const Value& value, const CodecScope& scope, std::string& out) {
  if (value.kind != Kind::kScalar) return wrong_type(value, scope, "a text");
  out = value.text;
  return true;
}

bool decode_scalar(const Value& value, const CodecScope& scope, std::filesystem::path& out) {
  if (value.kind != Kind::kScalar) return wrong_type(value, scope, "a path");
  if (value.text.empty() && scope.range.is_required) {
    return scope.error("config.missing_key", value, "the path is empty");
  }
  const std::filesystem::path path(value.text);
  const bool stays = value.text.empty() || path.is_absolute() || scope.folder.empty();
  out = stays ? path : (scope.folder / path).lexically_normal();
  return true;
}

bool decode_scalar(const Value& value, const CodecScope& scope, Length& out) {
  return decode_quantity<Length>(
      value, scope, out, parse_length, [](const Length& length) { return length.value; }, "a length",
      "mm, um, cm, m, voxel", "0.45 mm or 0.3 voxel");
}

bool decode_scalar(const Value& value, const CodecScope& scope, Angle& out) {
  return decode_quantity<Angle>(
      value, scope, out, parse_angle, [](const Angle& angle) { return angle.degrees; }, "an angle",
      "deg, rad", "20 deg");
}

bool decode_scalar(const Value& value, const CodecScope& scope, ByteSize& out) {
  return decode_quantity<ByteSize>(
      value, scope, out, parse_byte_size,
      [](const ByteSize& size) { return static_cast<double>(size.bytes); }, "a size",
      "B, kB, MB, GB, TB, KiB, MiB, GiB, TiB", "4GiB or 500MB");
}

bool decode_choice(const Value& value, const CodecScope& scope, const std::vector<std::string>& names,
                   std::size_t& out) {
  const std::string wanted = fmt::format("one of {}", fmt::join(names, ", "));
  if (value.kind != Kind::kScalar) return wrong_type(value, scope, wanted);
  const auto found = std::find(names.begin(), names.end(), value.text);
  out = static_cast<std::size_t>(found - names.begin());
  if (found != names.end()) return true;
  const std::string near = nearest_name(value.text, names);
  return scope.error("config.unknown_choice", value, fmt::format("{} is not {}", shown(value), wanted),
                     near.empty() ? "" : fmt::format("did you mean '{}'?", near));
}

bool decode_text(const Value& value, const CodecScope& scope, const std::string& form, std::string& out) {
  if (value.kind != Kind::kScalar) return form_error(value, scope, form);
  out = value.text;
  return true;
}

bool form_error(const Value& value, const CodecScope& scope, const std::string& form) {
  return wrong_type(value, scope, "of the form " + form);
}

bool expect_list(const Value& value, const CodecScope& scope, std::size_t count) {
  const bool fits = value.kind == Kind::kList && (count == 0 || value.items.size() == count);
  if (fits) return true;
  const std::string wanted = count == 0 ? "a list" : fmt::format("a list of {}", count);
  const std::string got =
      value.kind == Kind::kList ? fmt::format("a list of {}", value.items.size()) : shown(value);
  return scope.error("config.wrong_type", value, fmt::format("{} is not {}", got, wanted));
}

bool expect_map(const Value& value, const CodecScope& scope) {
  return value.kind == Kind::kMap || wrong_type(value, scope, "a map of keys and values");
}

Value encode_scalar(bool value, const CodecScope& /*scope*/) {
  return Value::scalar(value ? "true" : "false");
}
Value encode_scalar(std::int64_t value, const CodecScope& /*scope*/) {
  return Value::scalar(std::to_string(value));
}
Value encode_scalar(std::uint64_t value, const CodecScope& /*scope*/) {
  return Value::scalar(std::to_string(value));
}
Value encode_scalar(double value, const CodecScope& scope) {
  const std::vector<Unit> units = units_of(scope.quantity);
  if (units.empty() || units.front().name.empty()) return Value::scalar(to_text(value));
  return Value::scalar(to_text(value) + " " + std::string(units.front().name));
}
Value encode_scalar(float value, const CodecScope& scope) {
  // The float's own shortest text where the way through double keeps it, else every digit.
  std::array<char, 32> buffer{};
  const auto [end, error] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  const std::optional<double> back =
      parse_number(std::string_view(buffer.data(), static_cast<std::size_t>(end - buffer.data())));
  const bool is_kept = error == std::errc{} && back && static_cast<float>(*back) == value;
  return encode_scalar(is_kept ? *back : static_cast<double>(value), scope);
}
Value encode_scalar(const std::string& value, const CodecScope& /*scope*/) {
  Value scalar = Value::scalar(value);
  scalar.is_quoted = !is_plain_word(value);
  return scalar;
}
Value encode_scalar(const std::filesystem::path& value, const CodecScope& scope) {
  const bool stays = value.empty() || scope.folder.empty();
  return encode_scalar(
      stays ? value.generic_string() : value.lexically_proximate(scope.folder).generic_string(), scope);
}
Value encode_scalar(const Length& value, const CodecScope& /*scope*/) {
  return Value::scalar(to_text(value));
}
Value encode_scalar(const Angle& value, const CodecScope& /*scope*/) {
  return Value::scalar(to_text(value));
}
Value encode_scalar(const ByteSize& value, const CodecScope& /*scope*/) {
  return Value::scalar(to_text(value));
}

}  // namespace periost
