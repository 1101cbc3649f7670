#include "pipeline/data/keep_components.h"

#include <charconv>

namespace periost {

std::optional<KeepComponents> KeepComponents::parse(std::string_view text) {
  if (text == "all") return KeepComponents{0};
  if (text == "largest") return KeepComponents{1};
  std::uint32_t count = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), count);
  const bool is_whole = error == std::errc{} && end == text.data() + text.size();
  if (!is_whole || count == 0 || text.front() == '0') return std::nullopt;
  return KeepComponents{count};
}

std::string KeepComponents::text() const {
  return count == 0 ? "all" : count == 1 ? "largest" : std::to_string(count);
}

}  // namespace periost
