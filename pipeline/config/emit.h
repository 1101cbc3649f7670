#pragma once
// A Value tree as YAML text that reads back to the same tree.
#include <string>

#include "pipeline/param/value.h"

namespace periost {

// Block style, lists of scalars in flow style, ends with a line feed. A `${` in a text is written `$${`, so
// that reading expands nothing. Precondition: the root is a map.
std::string emit_yaml(const Value& document);

}  // namespace periost
