#pragma once
// Reading and writing single values: the part of the codecs (codec.h) that does not depend on a stage's own
// types.
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/param/param_info.h"

namespace periost {

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

}  // namespace periost
