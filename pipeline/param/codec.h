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
#include <array>
#include <concepts>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "pipeline/data/vec.h"
#include "pipeline/param/param_info.h"

namespace periost {

template <class E>
struct Choice {
  E value;
  std::string name;  // as written in the configuration
  std::string doc;   // one sentence
};

template <class Options>
class ParamTable;

// Where a value stands and what is asked of it, while it is decoded or encoded.
struct CodecScope {
  std::string key{};  // path within the stage: "raw.dims[1]"
  Quantity quantity = Quantity::kNone;
  Range range{};
  std::filesystem::path folder{};      // relative paths in the document start here; empty: left as they are
  Diagnostics* diagnostics = nullptr;  // decoding only

  CodecScope at(const std::string& sub_key) const;
  CodecScope at(std::size_t index) const;
  // Adds an error at the value's place; returns false, so that a decoder can `return scope.error(...)`.
  bool error(const char* code, const Value& at, std::string text, std::string hint = {}) const;
};

// Decoders return false after adding a diagnostic; `out` is then unspecified.
bool decode_scalar(const Value& value, const CodecScope& scope, bool& out);
bool decode_scalar(const Value& value, const CodecScope& scope, std::int64_t least, std::uint64_t largest,
                   std::int64_t& out);
bool decode_scalar(const Value& value, const CodecScope& scope, std::uint64_t& out);
bool decode_scalar(const Value& value, const CodecScope& scope, double& out);
bool decode_scalar(const Value& value, const CodecScope& scope, std::string& out);
bool decode_scalar(const Value& value, const CodecScope& scope, std::filesystem::path& out);
bool decode_scalar(const Value& value, const CodecScope& scope, Length& out);
bool decode_scalar(const Value& value, const CodecScope& scope, Angle& out);
bool decode_scalar(const Value& value, const CodecScope& scope, ByteSize& out);
// The index of the choice that the value names.
bool decode_choice(const Value& value, const CodecScope& scope, const std::vector<std::string>& names,
                   std::size_t& out);
// The text of a scalar for a text type.
bool decode_text(const Value& value, const CodecScope& scope, const std::string& form, std::string& out);
bool form_error(const Value& value, const CodecScope& scope, const std::string& form);
bool expect_list(const Value& value, const CodecScope& scope, std::size_t count);
bool expect_map(const Value& value, const CodecScope& scope);

Value encode_scalar(bool value, const CodecScope& scope);
Value encode_scalar(std::int64_t value, const CodecScope& scope);
Value encode_scalar(std::uint64_t value, const CodecScope& scope);
Value encode_scalar(double value, const CodecScope& scope);
Value encode_scalar(float value, const CodecScope& scope);
Value encode_scalar(const std::string& value, const CodecScope& scope);
Value encode_scalar(const std::filesystem::path& value, const CodecScope& scope);
Value encode_scalar(const Length& value, const CodecScope& scope);
Value encode_scalar(const Angle& value, const CodecScope& scope);
Value encode_scalar(const ByteSize& value, const CodecScope& scope);

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

template <class T>
struct Codec<std::optional<T>> {
  static TypeInfo describe() {
    TypeInfo type = Codec<T>::describe();
    type.is_optional = true;
    return type;
  }
  static bool decode(const Value& value, const CodecScope& scope, std::optional<T>& out) {
    out.reset();
    return value.kind == Value::Kind::kNull || Codec<T>::decode(value, scope, out.emplace());
  }
  static Value encode(const std::optional<T>& value, const CodecScope& scope) {
    return value ? Codec<T>::encode(*value, scope) : Value{};
  }
};

template <class T>
struct Codec<std::vector<T>> {
  static TypeInfo describe() {
    return {.kind = TypeInfo::Kind::kList, .element = std::make_shared<const TypeInfo>(Codec<T>::describe())};
  }
  static bool decode(const Value& value, const CodecScope& scope, std::vector<T>& out) {
    out.clear();
    if (value.kind == Value::Kind::kScalar) return Codec<T>::decode(value, scope, out.emplace_back());
    if (!expect_list(value, scope, 0)) return false;
    bool is_good = true;
    for (std::size_t i = 0; i < value.items.size(); ++i) {
      T item{};
      is_good = Codec<T>::decode(value.items[i], scope.at(i), item) && is_good;
      out.push_back(std::move(item));
    }
    return is_good;
  }
  static Value encode(const std::vector<T>& values, const CodecScope& scope) {
    Value list = Value::list({});
    for (const T& value : values) list.items.push_back(Codec<T>::encode(value, scope));
    return list;
  }
};

template <class T, std::size_t N>
struct Codec<std::array<T, N>> {
  static TypeInfo describe() {
    return {.kind = TypeInfo::Kind::kArray,
            .count = N,
            .element = std::make_shared<const TypeInfo>(Codec<T>::describe())};
  }
  static bool decode(const Value& value, const CodecScope& scope, std::array<T, N>& out) {
    if (!expect_list(value, scope, N)) return false;
    bool is_good = true;
    for (std::size_t i = 0; i < N; ++i) {
      is_good = Codec<T>::decode(value.items[i], scope.at(i), out[i]) && is_good;
    }
    return is_good;
  }
  static Value encode(const std::array<T, N>& values, const CodecScope& scope) {
    Value list = Value::list({});
    for (const T& value : values) list.items.push_back(Codec<T>::encode(value, scope));
    return list;
  }
};

template <>
struct Codec<Vec3> {
  using Array = std::array<double, 3>;
  static TypeInfo describe() { return Codec<Array>::describe(); }
  static bool decode(const Value& value, const CodecScope& scope, Vec3& out) {
    Array array{};
    if (!Codec<Array>::decode(value, scope, array)) return false;
    out = {array[0], array[1], array[2]};
    return true;
  }
  static Value encode(const Vec3& value, const CodecScope& scope) {
    return Codec<Array>::encode({value.x, value.y, value.z}, scope);
  }
};

template <class T>
struct Codec<std::map<std::string, T>> {
  static TypeInfo describe() {
    return {.kind = TypeInfo::Kind::kMap, .element = std::make_shared<const TypeInfo>(Codec<T>::describe())};
  }
  static bool decode(const Value& value, const CodecScope& scope, std::map<std::string, T>& out) {
    out.clear();
    if (!expect_map(value, scope)) return false;
    bool is_good = true;
    for (const Value::Entry& entry : value.entries) {
      is_good = Codec<T>::decode(entry.value, scope.at(entry.key), out[entry.key]) && is_good;
    }
    return is_good;
  }
  static Value encode(const std::map<std::string, T>& values, const CodecScope& scope) {
    Value map = Value::map({});
    for (const auto& [name, value] : values) {
      map.entries.push_back({name, {}, Codec<T>::encode(value, scope)});
    }
    return map;
  }
};

}  // namespace periost
