#include "pipeline/config/override.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <set>
#include <string_view>

#include "pipeline/config/yaml_document.h"

namespace periost {
namespace {

std::string text_of(const Value& map, const char* key) {
  const Value* value = map.find(key);
  return value != nullptr && value->kind == Value::Kind::kScalar ? value->text : std::string();
}

Value* find(Value& map, std::string_view key) {
  const auto found = std::find_if(map.entries.begin(), map.entries.end(),
                                  [&](const Value::Entry& entry) { return entry.key == key; });
  return found == map.entries.end() ? nullptr : &found->value;
}

// One override while it is applied.
struct Override {
  std::string text;      // as typed
  std::string_view key;  // left of '='
  SourcePlace place;
  Diagnostics& diagnostics;

  void error(const char* code, std::string sentence, std::string hint = {}) const {
    diagnostics.push_back(
        {Severity::kError, code, {}, std::string(key), place, std::move(sentence), std::move(hint)});
  }
};

// Takes the next key off the path: a text in quotes, else the longest existing key that starts the path, else
// all up to the next dot or bracket.
std::string take_key(std::string_view& path, const Value& map) {
  const auto cut = [&](std::size_t length, std::size_t skip) {
    std::string key(path.substr(0, length));
    path.remove_prefix(std::min(length + skip, path.size()));
    if (!path.empty() && path.front() == '.') path.remove_prefix(1);
    return key;
  };
  if (!path.empty() && path.front() == '"') {
    path.remove_prefix(1);
    return cut(std::min(path.find('"'), path.size()), 1);
  }
  std::size_t longest = 0;
  for (const Value::Entry& entry : map.entries) {
    const bool starts = path.substr(0, entry.key.size()) == entry.key;
    const std::size_t end = entry.key.size();
    if (starts && (end == path.size() || path[end] == '.' || path[end] == '['))
      longest = std::max(longest, end);
  }
  return cut(longest > 0 ? longest : std::min(path.find_first_of(".["), path.size()), 0);
}

// The item that `[N]` at the start of the path names, or null after an error.
Value* take_item(std::string_view& path, Value& list, const Override& override) {
  std::size_t index = 0;
  const std::size_t close = path.find(']');
  const char* last = path.data() + std::min(close, path.size());
  const auto [end, error] = std::from_chars(path.data() + 1, last, index);
  const bool is_index = close != std::string_view::npos && error == std::errc{} && end == last;
  if (!is_index || list.kind != Value::Kind::kList || index >= list.items.size()) {
    override.error("config.bad_override", fmt::format("there is no list item at '{}'", path));
    return nullptr;
  }
  path.remove_prefix(close + 1);
  if (!path.empty() && path.front() == '.') path.remove_prefix(1);
  return &list.items[index];
}

// Follows the path through maps and lists, adding maps that are missing, and sets the value at its end.
void set_at(Value* at, std::string_view path, Value value, const Override& override) {
  while (!path.empty()) {
    if (path.front() == '[') {
      at = take_item(path, *at, override);
      if (at == nullptr) return;
      continue;
    }
    if (at->kind != Value::Kind::kMap) {
      Value map = Value::map({});
      map.place = override.place;
      *at = std::move(map);
    }
    const std::string key = take_key(path, *at);
    if (key.empty())
      return override.error("config.bad_override", fmt::format("'{}' has an empty key", override.key));
    if (find(*at, key) == nullptr) at->entries.push_back({key, override.place, {}});
    at = find(*at, key);
  }
  *at = std::move(value);
}

void place_everywhere(Value& value, const SourcePlace& place) {
  value.place = place;
  for (Value& item : value.items) place_everywhere(item, place);
  for (Value::Entry& entry : value.entries) {
    entry.place = place;
    place_everywhere(entry.value, place);
  }
}

struct Target {
  Value* value = nullptr;
  std::string_view path;
};

// The stage that the path starts with, by id, else by kind; null after an error.
Target find_stage(Value& chain, std::string_view path, const Override& override) {
  const std::string name(path.substr(0, path.find_first_of(".[")));
  const std::vector<std::string> ids = stage_ids(chain);
  std::vector<std::size_t> matches;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (!ids[i].empty() && ids[i] == name) matches.push_back(i);
  }
  const auto of_kind = [&](std::size_t i) { return text_of(chain.items[i], "stage") == name; };
  // A kind that is there more than once is ambiguous, even though the first of them has it as its default id.
  const bool is_default_id = matches.size() == 1 && text_of(chain.items[matches[0]], "id").empty();
  if (matches.empty() || is_default_id) {
    matches.clear();
    for (std::size_t i = 0; i < ids.size(); ++i) {
      if (of_kind(i) || ids[i] == name) matches.push_back(i);
    }
  }
  path.remove_prefix(std::min(name.size() + 1, path.size()));
  if (matches.size() == 1) return {&chain.items[matches[0]], path};
  if (matches.empty()) {
    std::vector<std::string> known = ids;
    known.insert(known.end(), {"feedback", "provenance", "seed", "name", "plugins"});
    const std::string near = nearest_name(name, known);
    override.error("config.unknown_id", fmt::format("no stage has the id or kind '{}'", name),
                   near.empty() ? "" : fmt::format("did you mean '{}'?", near));
  } else {
    std::vector<std::string> candidates;
    for (const std::size_t i : matches) candidates.push_back(ids[i]);
    override.error("config.ambiguous_id", fmt::format("{} stages are of kind '{}'", matches.size(), name),
                   fmt::format("give them an id; now they are {}", fmt::join(candidates, ", ")));
  }
  return {};
}

}  // namespace

std::vector<std::string> stage_ids(const Value& chain) {
  std::vector<std::string> ids;
  std::set<std::string> taken;
  for (const Value& entry : chain.items) taken.insert(ids.emplace_back(text_of(entry, "id")));
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const std::string kind = text_of(chain.items[i], "stage");
    if (!ids[i].empty() || kind.empty()) continue;
    std::string id = kind;
    for (int number = 2; !taken.insert(id).second; ++number) id = fmt::format("{}_{}", kind, number);
    ids[i] = id;
  }
  return ids;
}

void apply_override(Value& document, const std::string& text, Diagnostics& diagnostics) {
  const std::size_t equals = text.find('=');
  const SourcePlace place{"--set " + text, 0, 0};
  const Override override{text, std::string_view(text).substr(0, equals), place, diagnostics};
  if (equals == std::string::npos || equals == 0) {
    return override.error("config.bad_override", "an override has the form KEY=VALUE",
                          "as in decimate.distance=0.3voxel");
  }
  const std::size_t before = diagnostics.size();
  Value value = parse_yaml(text.substr(equals + 1), place.file, diagnostics);
  place_everywhere(value, place);
  for (std::size_t i = before; i < diagnostics.size(); ++i) diagnostics[i].place = place;
  if (diagnostics.size() != before || document.kind != Value::Kind::kMap) return;

  const std::string first(override.key.substr(0, override.key.find_first_of(".[")));
  const bool is_top = first == "feedback" || first == "provenance" || first == "seed" || first == "name" ||
                      first == "plugins" || first == "chain";
  if (is_top) return set_at(&document, override.key, std::move(value), override);
  Value* chain = find(document, "chain");
  if (chain == nullptr || chain->kind != Value::Kind::kList) return;  // reported with the document itself
  const Target target = find_stage(*chain, override.key, override);
  if (target.value == nullptr) return;
  if (target.path.empty()) return override.error("config.bad_override", "a key of the stage is missing");
  set_at(target.value, target.path, std::move(value), override);
}

}  // namespace periost
