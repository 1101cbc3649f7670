#pragma once
// The parameters of an Options struct, declared once: member, quantity, range and sentence, all mandatory;
// the default is what Options{} holds. Decoding, encoding, help, Markdown and JSON Schema follow from it
// (render.h).
#include <any>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/param/codec.h"

namespace periost {

// The table without the type of its Options, as the framework sees it.
class ParamTableBase {
 public:
  virtual ~ParamTableBase() = default;
  const std::vector<ParamInfo>& params() const { return params_; }

  // Options{} with the keys of `map` set; a null or missing map sets none. Adds a diagnostic with its place
  // for every unknown key (config.unknown_key), value of the wrong form (config.wrong_type), unit that does
  // not fit (config.wrong_unit), number out of range (config.out_of_range) and required key left out
  // (config.missing_key). Relative paths start at `folder`. The result is usable only if no error was added.
  virtual std::any decode(const Value& map, Diagnostics& diagnostics,
                          const std::filesystem::path& folder = {}) const = 0;
  // Every key with its value; decode(encode(x)) is x, bit for bit. Paths are written relative to `folder` if
  // given.
  virtual Value encode(const std::any& options, const std::filesystem::path& folder = {}) const = 0;
  virtual std::any defaults() const = 0;

 protected:
  // Adds diagnostics for keys of `map` that are not declared and for required ones that are missing.
  void check_keys(const Value& map, const CodecScope& scope) const;
  std::vector<ParamInfo> params_;
};

template <class Options>
class ParamTable final : public ParamTableBase {
 public:
  // Declares the key `name` for a member. The member's type decides the form of the value (codec.h), the
  // quantity its units, the range its bounds.
  template <class Member>
  ParamTable& param(std::string name, Member Options::*member, Quantity quantity, Range range,
                    std::string doc) {
    const CodecScope scope{.key = {}, .quantity = quantity, .range = range, .folder = {}};
    params_.push_back({name, Codec<Member>::describe(), quantity, range, std::move(doc),
                       Codec<Member>::encode(Options{}.*member, scope)});
    accessors_.push_back({[member](const Value& value, const CodecScope& at, Options& options) {
                            return Codec<Member>::decode(value, at, options.*member);
                          },
                          [member](const Options& options, const CodecScope& at) {
                            return Codec<Member>::encode(options.*member, at);
                          }});
    return *this;
  }

  bool decode_into(const Value& map, const CodecScope& scope, Options& options) const {
    const std::size_t before = scope.diagnostics->size();
    check_keys(map, scope);
    for (std::size_t i = 0; i < params_.size(); ++i) {
      const Value* value = map.find(params_[i].name);
      if (value != nullptr) accessors_[i].decode(*value, inner(scope, i), options);
    }
    return scope.diagnostics->size() == before;
  }
  Value encode_all(const Options& options, const CodecScope& scope) const {
    Value map = Value::map({});
    for (std::size_t i = 0; i < params_.size(); ++i) {
      map.entries.push_back({params_[i].name, {}, accessors_[i].encode(options, inner(scope, i))});
    }
    return map;
  }

  std::any decode(const Value& map, Diagnostics& diagnostics,
                  const std::filesystem::path& folder = {}) const override {
    Options options{};
    CodecScope scope;
    scope.folder = folder;
    scope.diagnostics = &diagnostics;
    if (map.kind == Value::Kind::kNull)
      check_keys(map, scope);
    else if (expect_map(map, scope))
      decode_into(map, scope, options);
    return options;
  }
  Value encode(const std::any& options, const std::filesystem::path& folder = {}) const override {
    CodecScope scope;
    scope.folder = folder;
    return encode_all(std::any_cast<const Options&>(options), scope);
  }
  std::any defaults() const override { return Options{}; }

 private:
  struct Accessors {
    std::function<bool(const Value&, const CodecScope&, Options&)> decode;
    std::function<Value(const Options&, const CodecScope&)> encode;
  };
  CodecScope inner(const CodecScope& scope, std::size_t i) const {
    CodecScope result = scope.at(params_[i].name);
    result.quantity = params_[i].quantity;
    result.range = params_[i].range;
    return result;
  }
  std::vector<Accessors> accessors_;
};

// Groups: structs that declare their own keys.
template <class T>
ParamTable<T> group_table() {
  ParamTable<T> table;
  declare_params(table);
  return table;
}

template <class T>
TypeInfo Codec<T>::describe() {
  return {.kind = TypeInfo::Kind::kGroup,
          .fields = std::make_shared<const std::vector<ParamInfo>>(group_table<T>().params())};
}
template <class T>
bool Codec<T>::decode(const Value& value, const CodecScope& scope, T& out) {
  return expect_map(value, scope) && group_table<T>().decode_into(value, scope, out);
}
template <class T>
Value Codec<T>::encode(const T& value, const CodecScope& scope) {
  return group_table<T>().encode_all(value, scope);
}

}  // namespace periost
