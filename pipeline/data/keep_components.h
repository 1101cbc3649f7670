#pragma once
// How many connected parts of an object stay, the largest first: `all`, `largest`, or a number.
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace periost {

struct KeepComponents {
  std::uint32_t count = 0;  // 0: all

  static std::optional<KeepComponents> parse(std::string_view text);
  std::string text() const;
  static std::string form() { return "all | largest | a whole number"; }
  friend bool operator==(const KeepComponents&, const KeepComponents&) = default;
};

}  // namespace periost
