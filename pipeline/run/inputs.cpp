#include "pipeline/run/inputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>

#include "pipeline/base/error.h"
#include "pipeline/base/hash.h"

namespace periost {
namespace {

namespace fs = std::filesystem;

using Replace = std::function<std::string(const fs::path&)>;

Value replaced(const ParamInfo& param, const TypeInfo& type, const Value& value, const Replace& replace);

Value replaced_fields(const std::vector<ParamInfo>& params, Value map, const Replace& replace) {
  for (Value::Entry& entry : map.entries) {
    const auto param =
        std::find_if(params.begin(), params.end(), [&](const ParamInfo& p) { return p.name == entry.key; });
    if (param != params.end()) entry.value = replaced(*param, param->type, entry.value, replace);
  }
  return map;
}

Value replaced(const ParamInfo& param, const TypeInfo& type, const Value& value, const Replace& replace) {
  if (value.kind == Value::Kind::kNull) return value;
  if (type.kind == TypeInfo::Kind::kGroup && type.fields)
    return replaced_fields(*type.fields, value, replace);
  Value result = value;
  if (type.element && value.kind == Value::Kind::kList) {
    for (Value& item : result.items) item = replaced(param, *type.element, item, replace);
  } else if (type.element && value.kind == Value::Kind::kMap) {
    for (Value::Entry& entry : result.entries)
      entry.value = replaced(param, *type.element, entry.value, replace);
  } else if (param.quantity == Quantity::kInputPath && value.kind == Value::Kind::kScalar &&
             !value.text.empty()) {
    result.text = replace(value.text);
  }
  return result;
}

std::string trimmed(std::string text) {
  const auto is_blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  while (!text.empty() && is_blank(text.back())) text.pop_back();
  const auto first = std::find_if_not(text.begin(), text.end(), is_blank);
  return {first, text.end()};
}

// The file that holds the voxels of a header, or nothing when the header holds them itself.
fs::path detached_data(const fs::path& header) {
  const std::string extension = header.extension().string();
  if (extension == ".hdr") {
    fs::path pair = header;
    pair.replace_extension(".img");
    return fs::is_regular_file(pair) ? pair : fs::path();
  }
  if (extension != ".mhd" && extension != ".nhdr") return {};
  constexpr std::array<std::string_view, 3> kKeys{"ElementDataFile", "data file", "datafile"};
  constexpr int kHeaderLines = 200;
  std::ifstream file(header);
  std::string line;
  for (int i = 0; i < kHeaderLines && std::getline(file, line); ++i) {
    const std::size_t mark = line.find_first_of("=:");
    if (mark == std::string::npos) continue;
    const std::string key = trimmed(line.substr(0, mark));
    if (std::find(kKeys.begin(), kKeys.end(), key) == kKeys.end()) continue;
    const fs::path data = header.parent_path() / trimmed(line.substr(mark + 1));
    if (fs::is_regular_file(data)) return data;
  }
  return {};
}

std::vector<fs::path> files_behind(const fs::path& path) {
  std::vector<fs::path> files;
  if (fs::is_directory(path)) {
    for (const auto& entry : fs::recursive_directory_iterator(path)) {
      if (entry.is_regular_file()) files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    return files;
  }
  files.push_back(path);
  const fs::path data = detached_data(path);
  if (!data.empty()) files.push_back(data);
  return files;
}

}  // namespace

InputContent read_content(const fs::path& path) {
  InputContent content;
  content.path = path;
  Hasher hasher;
  try {
    const bool is_folder = fs::is_directory(path);
    for (const fs::path& file : files_behind(path)) {
      FileRecord record{file.string(), 0, hash_file(file)};
      record.bytes = fs::file_size(file);
      // The name of a single file is not part of its content (its extension, which may choose the reader,
      // is).
      hasher.add(is_folder ? fs::relative(file, path).string() : file.extension().string())
          .add(record.xxh128);
      content.files.push_back(std::move(record));
    }
  } catch (const fs::filesystem_error& failure) {
    throw Error(ErrorKind::kInput, "file.unreadable",
                fmt::format("cannot read '{}': {}", path.string(), failure.code().message()),
                "check that it exists and that you may read it");
  }
  content.hash = hasher.hex();
  return content;
}

std::vector<fs::path> input_paths(const std::vector<ParamInfo>& params, const Value& values) {
  std::vector<fs::path> paths;
  with_input_paths(params, values, [&paths](const fs::path& path) {
    paths.push_back(path);
    return path.string();
  });
  return paths;
}

Value with_input_paths(const std::vector<ParamInfo>& params, const Value& values, const Replace& replace) {
  return replaced_fields(params, values, replace);
}

}  // namespace periost
