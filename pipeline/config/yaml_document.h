#pragma once
// YAML text to a Value tree with places. The only file that knows the YAML library.
#include <string>

#include "pipeline/base/diagnostic.h"
#include "pipeline/param/value.h"

namespace periost {

inline constexpr std::size_t kLargestDocument = std::size_t{1} << 20;  // bytes
inline constexpr int kDeepestDocument = 32;                            // nested lists and maps

// Parses one document. What YAML leaves open or lets pass is refused with a place: duplicate keys
// (config.duplicate_key), merge keys (config.merge_key), anchors and aliases (config.anchor), tags
// (config.tag), keys that are not plain texts, several documents, tabs for indentation, control characters,
// text that is not UTF-8, documents over the limits above (config.too_large, config.too_deep), and syntax
// errors (config.syntax). After an error the result may be incomplete; an empty document is null.
Value parse_yaml(const std::string& text, const std::string& file, Diagnostics& diagnostics);

}  // namespace periost
