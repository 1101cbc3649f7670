#pragma once
// The files that a stage reads, found from its declared parameters (Quantity::kInputPath), and pinned by
// content.
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "pipeline/param/param_info.h"
#include "pipeline/run/manifest.h"

namespace periost {

// The content of a file or folder that a parameter names. A folder stands for all files below it; a header
// with detached data (.mhd, .nhdr, .hdr) for itself and its data file.
struct InputContent {
  std::filesystem::path path;     // as in the parameter
  std::vector<FileRecord> files;  // full paths, in a fixed order
  std::string hash;               // of all names (without folder) and contents
};

// Throws Error{kInput, "file.unreadable"} naming the file.
InputContent read_content(const std::filesystem::path& path);

// Every non-empty input path among encoded parameters; lists, groups and maps are searched. `values` is what
// ParamTableBase::encode gave for `params`.
std::vector<std::filesystem::path> input_paths(const std::vector<ParamInfo>& params, const Value& values);

// `values` with each input path replaced by what `replace` makes of it.
Value with_input_paths(const std::vector<ParamInfo>& params, const Value& values,
                       const std::function<std::string(const std::filesystem::path&)>& replace);

}  // namespace periost
