#pragma once
// How a C++ type is read from a Value and written to one. Supported members of an Options struct:
//   bool, int, (u)int32/64, float, double, std::string, std::filesystem::path, Length, Angle, ByteSize, Vec3,
//   std::optional<T>, std::vector<T>, std::array<T, N>, std::map<std::string, T>, and
//   - enumerations: a function `std::vector<Choice<E>> choices_of(E)` beside the enumeration;
//   - text types (`keep: all | largest | N`): a struct with
//       static std::optional<T> parse(std::string_view text);
//       std::string text() const;            // parse(text()) gives the same value back
//       static std::string form();           // "all | largest | N"
//   - groups: a struct with a function `void declare_params(ParamTable<T>&)` beside it.
// "Beside" means in the type's own namespace (not an unnamed one), visible in stage.cpp; it may be `static`
// there.
#include <concepts>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "pipeline/param/param_info.h"
#include "pipeline/param/scalar_codec.h"

namespace periost {

template <class E>
struct Choice {
  E value;
  std::string name;  // as written in the configuration
  std::string doc;   // one sentence
};

template <class Options>
class ParamTable;

template <class T>
concept TextType = requires(const T& value, std::string_view text) {
  { T::parse(text) } -> std::same_as<std::optional<T>>;
  { value.text() } -> std::convertible_to<std::string>;
  { T::form() } -> std::convertible_to<std::string>;
};

template <class T>
concept WholeNumber = std::integral<T> && !std::same_as<T, bool>;

// Each codec has describe(), decode(value, scope, out) and encode(value, scope). The primary one is for
// groups; it is defined in param_table.h.
template <class T>
struct Codec {
  static TypeInfo describe();
  static bool decode(const Value& value, const CodecScope& scope, T& out);
  static Value encode(const T& value, const CodecScope& scope);
};

template <class T, TypeInfo::Kind kKind>
struct ScalarCodec {
  static TypeInfo describe() { return {.kind = kKind}; }
  static bool decode(const Value& value, const CodecScope& scope, T& out) {
    return decode_scalar(value, scope, out);
  }
  static Value encode(const T& value, const CodecScope& scope) { return encode_scalar(value, scope); }
};

template <>
struct Codec<bool> : ScalarCodec<bool, TypeInfo::Kind::kSwitch> {};
template <>
struct Codec<double> : ScalarCodec<double, TypeInfo::Kind::kNumber> {};
template <>
struct Codec<std::string> : ScalarCodec<std::string, TypeInfo::Kind::kText> {};
template <>
struct Codec<std::filesystem::path> : ScalarCodec<std::filesystem::path, TypeInfo::Kind::kPath> {};
template <>
struct Codec<Length> : ScalarCodec<Length, TypeInfo::Kind::kLength> {};
template <>
struct Codec<Angle> : ScalarCodec<Angle, TypeInfo::Kind::kAngle> {};
template <>
struct Codec<ByteSize> : ScalarCodec<ByteSize, TypeInfo::Kind::kSize> {};

template <>
struct Codec<float> {
  static TypeInfo describe() { return {.kind = TypeInfo::Kind::kNumber}; }
  static bool decode(const Value& value, const CodecScope& scope, float& out) {
    double number = 0;
    if (!decode_scalar(value, scope, number)) return false;
    out = static_cast<float>(number);
    return true;
  }
  static Value encode(float value, const CodecScope& scope) { return encode_scalar(value, scope); }
};

template <WholeNumber T>
struct Codec<T> {
  static TypeInfo describe() {
    return {.kind = TypeInfo::Kind::kInteger,
            .least = static_cast<double>(std::numeric_limits<T>::min()),
            .largest = static_cast<double>(std::numeric_limits<T>::max())};
  }
  static bool decode(const Value& value, const CodecScope& scope, T& out) {
    if constexpr (std::unsigned_integral<T> && sizeof(T) == sizeof(std::uint64_t)) {
      std::uint64_t number = 0;
      if (!decode_scalar(value, scope, number)) return false;
      out = static_cast<T>(number);
    } else {
      std::int64_t number = 0;
      constexpr auto kLeast = static_cast<std::int64_t>(std::numeric_limits<T>::min());
      constexpr auto kLargest = static_cast<std::uint64_t>(std::numeric_limits<T>::max());
      if (!decode_scalar(value, scope, kLeast, kLargest, number)) return false;
      out = static_cast<T>(number);
    }
    return true;
  }
  static Value encode(T value, const CodecScope& scope) {
    if constexpr (std::unsigned_integral<T>)
      return encode_scalar(static_cast<std::uint64_t>(value), scope);
    else
      return encode_scalar(static_cast<std::int64_t>(value), scope);
  }
};

template <class E>
  requires std::is_enum_v<E>
struct Codec<E> {
  static TypeInfo describe() {
    TypeInfo type{.kind = TypeInfo::Kind::kChoice};
    for (const Choice<E>& choice : choices_of(E{})) type.choices.push_back({choice.name, choice.doc});
    return type;
  }
  static bool decode(const Value& value, const CodecScope& scope, E& out) {
    const auto choices = choices_of(E{});
    std::vector<std::string> names;
    for (const Choice<E>& choice : choices) names.push_back(choice.name);
    std::size_t index = 0;
    if (!decode_choice(value, scope, names, index)) return false;
    out = choices[index].value;
    return true;
  }
  static Value encode(E value, const CodecScope& /*scope*/) {
    for (const Choice<E>& choice : choices_of(E{})) {
      if (choice.value == value) return Value::scalar(choice.name);
    }
    return {};
  }
};

template <TextType T>
struct Codec<T> {
  static TypeInfo describe() { return {.kind = TypeInfo::Kind::kForm, .form = T::form()}; }
  static bool decode(const Value& value, const CodecScope& scope, T& out) {
    std::string text;
    if (!decode_text(value, scope, T::form(), text)) return false;
    const std::optional<T> parsed = T::parse(text);
    if (!parsed) return form_error(value, scope, T::form());
    out = *parsed;
    return true;
  }
  static Value encode(const T& value, const CodecScope& /*scope*/) { return Value::scalar(value.text()); }
};

}  // namespace periost

#include "pipeline/param/container_codec.h"  // IWYU pragma: export
