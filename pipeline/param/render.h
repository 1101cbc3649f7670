#pragma once
// The declared parameters as text: for the terminal, for documentation, and as JSON Schema.
#include <string>
#include <vector>

#include "pipeline/param/param_info.h"

namespace periost {

// A value on one line, in YAML's flow style: `0.3 voxel`, `[1, 2, 3]`, `{limit: 8, warn: 12}`, `null`.
std::string flow_text(const Value& value);

// Whether a text stands for itself without quotes: not a number, a switch or null to any YAML reader.
bool is_plain_word(const std::string& text);

// The form of a type in a few words: "length", "list of number", "all | largest | N", "paper | certified".
std::string type_text(const ParamInfo& param);

// One paragraph a parameter: name, form, default, range, sentence, choices; nested keys are indented.
std::string help_text(const std::vector<ParamInfo>& params);

// A table (key, form, default, range, meaning), nested keys as `raw.dims`. Ends with a line feed; empty
// without parameters.
std::string markdown_table(const std::vector<ParamInfo>& params);

// A JSON Schema (draft 2020-12) of a map with these keys: {"type": "object", "properties": {...},
// "additionalProperties": false, "required": [...]}.
std::string json_schema(const std::vector<ParamInfo>& params);

// The parameters themselves as JSON, for `stages --format json`.
std::string json_list(const std::vector<ParamInfo>& params);

}  // namespace periost
