#pragma once
// A document node with its place, free of any YAML library: what configuration files are parsed into and
// options are decoded from and encoded to.
#include <string>
#include <utility>
#include <vector>

#include "pipeline/base/diagnostic.h"

namespace periost {

struct Value {
  enum class Kind { kNull, kScalar, kList, kMap };
  struct Entry;

  Kind kind = Kind::kNull;
  std::string text;            // scalars
  bool is_quoted = false;      // scalars: written in quotes, so never a number or a switch
  std::vector<Value> items;    // lists
  std::vector<Entry> entries;  // maps, in the order of the file; keys are unique
  SourcePlace place;

  static Value scalar(std::string text);
  static Value list(std::vector<Value> items);
  static Value map(std::vector<Entry> entries);
  // The value of a key of a map, or null.
  const Value* find(const std::string& key) const;
};

struct Value::Entry {
  std::string key;
  SourcePlace place;  // of the key
  Value value;
};

}  // namespace periost
