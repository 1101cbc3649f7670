#pragma once
// The small part of Apple's XML property lists that InVesalius writes: dict, array, string, integer, real,
// true, false.
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace periost {

struct PlistNode {
  enum class Kind { kText, kArray, kDict };
  Kind kind = Kind::kText;
  std::string text;                                        // kText: string, number, or "true" / "false"
  std::vector<PlistNode> items;                            // kArray
  std::vector<std::pair<std::string, PlistNode>> entries;  // kDict
  // The value of a key of a dict, or null.
  const PlistNode* find(std::string_view key) const;
};

// Throws std::runtime_error with what is wrong and at which byte. Entities are not resolved; comments and the
// document type are skipped; nesting is limited.
PlistNode parse_plist(std::string_view xml);

}  // namespace periost
