#pragma once
// What is known of one declared parameter: the single source of help, documentation, schema and decoding.
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "pipeline/base/quantity.h"
#include "pipeline/param/range.h"
#include "pipeline/param/value.h"

namespace periost {

// One allowed word of a parameter with choices.
struct ChoiceInfo {
  std::string name;  // "certified"
  std::string doc;   // one sentence
};

struct ParamInfo;

// The form of a value.
struct TypeInfo {
  enum class Kind {
    kSwitch,   // true | false
    kInteger,  // whole number
    kNumber,   // number, with the units of the parameter's quantity
    kText,     // any text
    kPath,     // file or folder, relative to the configuration's folder
    kLength,   // mm or voxel
    kAngle,    // deg or rad
    kSize,     // bytes
    kChoice,   // one of `choices`
    kForm,     // a text with its own grammar, described by `form`
    kList,     // any number of `element`; a single one may stand without brackets
    kArray,    // exactly `count` of `element`
    kGroup,    // a map with the keys `fields`
    kMap,      // a map from free names to `element`
  };
  Kind kind = Kind::kText;
  bool is_optional = false;                                // null is a value: "not set"
  double least = 0, largest = 0;                           // kInteger: bounds of the member's type
  std::vector<ChoiceInfo> choices{};                       // kChoice
  std::string form{};                                      // kForm: "all | largest | N"
  std::size_t count = 0;                                   // kArray
  std::shared_ptr<const TypeInfo> element{};               // kList, kArray, kMap
  std::shared_ptr<const std::vector<ParamInfo>> fields{};  // kGroup
};

struct ParamInfo {
  std::string name;
  TypeInfo type;
  Quantity quantity = Quantity::kNone;
  Range range;
  std::string doc;  // one sentence
  Value default_value;
};

}  // namespace periost
