#pragma once
// Codecs (codec.h) of types that hold others: optional, vector, array, Vec3, map.
#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/data/vec.h"
#include "pipeline/param/codec.h"

namespace periost {

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
