#include "pipeline/config/configuration.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "pipeline/base/error.h"
#include "pipeline/base/file.h"
#include "pipeline/config/environment.h"
#include "pipeline/config/override.h"
#include "pipeline/config/yaml_document.h"
#include "pipeline/param/param_table.h"

namespace periost {

// The raw list under `chain:`; its entries are decoded by stage, later.
struct ChainDocument {
  Value value = Value::list({});
};

template <>
struct Codec<ChainDocument> {
  static TypeInfo describe() {
    return {.kind = TypeInfo::Kind::kList,
            .element = std::make_shared<const TypeInfo>(TypeInfo{
                .kind = TypeInfo::Kind::kGroup, .fields = std::make_shared<std::vector<ParamInfo>>()})};
  }
  static bool decode(const Value& value, const CodecScope& scope, ChainDocument& out) {
    if (!expect_list(value, scope, 0)) return false;
    if (value.items.empty()) return scope.error("config.empty_chain", value, "there is no stage in it");
    out.value = value;
    return true;
  }
  static Value encode(const ChainDocument& chain, const CodecScope& /*scope*/) { return chain.value; }
};

static std::vector<Choice<Provenance::Paths>> choices_of(Provenance::Paths) {
  return {{Provenance::Paths::kFull, "full", "Absolute paths."},
          {Provenance::Paths::kBasename, "basename", "File names only."},
          {Provenance::Paths::kNone, "none", "No names."}};
}

static void declare_params(ParamTable<Provenance>& params) {
  params
      .param("dicom_uids", &Provenance::dicom_uids, Quantity::kNone, Range::any(),
             "Writes the DICOM UIDs of the series into run.json.")
      .param("paths", &Provenance::paths, Quantity::kNone, Range::any(),
             "How much of an input file's path run.json tells.");
}

static void declare_params(ParamTable<Feedback>& params) {
  params.param("until", &Feedback::until, Quantity::kNone, Range::any(), "What ends the rounds: pass.")
      .param("max_rounds", &Feedback::max_rounds, Quantity::kCount, Range::between(1, 20),
             "Most rounds that are run.");
}

namespace {

struct TopLevel {
  std::uint32_t periost = 1;
  std::string name;
  ChainDocument chain;
  std::optional<Feedback> feedback;
  std::vector<std::filesystem::path> plugins;
  Provenance provenance;
  std::uint64_t seed = 0;
};

ParamTable<TopLevel> top_level_table() {
  ParamTable<TopLevel> table;
  table
      .param("periost", &TopLevel::periost, Quantity::kCount, Range::between(1, 1).and_required(),
             "Version of this format.")
      .param("name", &TopLevel::name, Quantity::kNone, Range::any(),
             "Name of the run, used for its folder and files; left out, the configuration's own file name.")
      .param("chain", &TopLevel::chain, Quantity::kNone, Range::required(), "The stages, in order.")
      .param("feedback", &TopLevel::feedback, Quantity::kNone, Range::any(),
             "Repeats the chain with other parameters until its gates pass.")
      .param("plugins", &TopLevel::plugins, Quantity::kNone, Range::any(),
             "Shared libraries that bring further stages.")
      .param("provenance", &TopLevel::provenance, Quantity::kNone, Range::any(),
             "What run.json tells of where the data came from.")
      .param("seed", &TopLevel::seed, Quantity::kCount, Range::any(), "Seed of every random choice.");
  return table;
}

void add_error(Diagnostics& diagnostics, const char* code, const SourcePlace& place, std::string text,
               std::string hint = {}, std::string stage = {}) {
  diagnostics.push_back(
      {Severity::kError, code, std::move(stage), {}, place, std::move(text), std::move(hint)});
}

bool is_file_name(const std::string& name) {
  return !name.empty() && name.size() <= 100 && name[0] != '.' && name[0] != ' ' && name.back() != ' ' &&
         std::all_of(name.begin(), name.end(),
                     [](char c) { return c < 0 || (c >= ' ' && c != '/' && c != '\\'); });
}

bool is_id(const std::string& id) {
  const auto is_allowed = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  };
  return !id.empty() && std::all_of(id.begin(), id.end(), is_allowed);
}

void add_choice(const Value& value, const std::string& port, StageEntry& entry, Diagnostics& diagnostics) {
  if (value.kind == Value::Kind::kScalar) {
    entry.from.push_back({port, value.text, value.place});
  } else {
    add_error(diagnostics, "config.wrong_type", value.place, "key 'from': an id of a stage is wanted",
              "write an id, a list of ids, or input: id", entry.id);
  }
}

void decode_from(const Value& value, StageEntry& entry, Diagnostics& diagnostics) {
  if (value.kind == Value::Kind::kMap) {
    for (const Value::Entry& e : value.entries) add_choice(e.value, e.key, entry, diagnostics);
  } else if (value.kind == Value::Kind::kList) {
    for (const Value& item : value.items) add_choice(item, {}, entry, diagnostics);
  } else {
    add_choice(value, {}, entry, diagnostics);
  }
}

// A stage's own keys are what is left when those of the framework are taken out.
StageEntry decode_entry(const Value& value, const std::string& id, Diagnostics& diagnostics) {
  StageEntry entry;
  entry.id = id;
  entry.place = value.place;
  entry.params = Value::map({});
  entry.params.place = value.place;
  if (value.kind != Value::Kind::kMap) {
    add_error(diagnostics, "config.wrong_type", value.place,
              "an entry of the chain is a map with the key 'stage'", "write - stage: NAME");
    return entry;
  }
  for (const Value::Entry& e : value.entries) {
    const bool is_text = e.value.kind == Value::Kind::kScalar;
    if (e.key == "stage" && is_text) {
      entry.kind = e.value.text;
      entry.place = e.value.place;
    } else if (e.key == "id" && is_text && is_id(e.value.text)) {
      continue;  // stage_ids() has read it
    } else if (e.key == "id") {
      add_error(diagnostics, "config.bad_id", e.value.place, "an id has letters, digits, '_' and '-' only",
                {}, id);
    } else if (e.key == "from") {
      decode_from(e.value, entry, diagnostics);
    } else if (e.key != "stage") {
      entry.params.entries.push_back(e);
    }
  }
  if (entry.kind.empty()) {
    add_error(diagnostics, "config.missing_key", value.place, "the key 'stage' is missing",
              "write - stage: NAME");
  }
  return entry;
}

void decode_chain(const Value& chain, Configuration& configuration, Diagnostics& diagnostics) {
  const std::vector<std::string> ids = stage_ids(chain);
  std::set<std::string> seen;
  for (std::size_t i = 0; i < chain.items.size(); ++i) {
    StageEntry entry = decode_entry(chain.items[i], ids[i], diagnostics);
    if (!entry.id.empty() && !seen.insert(entry.id).second) {
      const Value* id = chain.items[i].find("id");
      add_error(diagnostics, "config.duplicate_id", id != nullptr ? id->place : entry.place,
                fmt::format("the id '{}' is given twice", entry.id));
    }
    configuration.chain.push_back(std::move(entry));
  }
}

SourcePlace place_of(const Value& document, const char* key) {
  const Value* value = document.find(key);
  return value != nullptr ? value->place : document.place;
}

Configuration decode(const Value& document, const std::filesystem::path& file, Diagnostics& diagnostics) {
  Configuration configuration;
  configuration.file = file;
  configuration.folder = std::filesystem::absolute(file).parent_path().lexically_normal();
  configuration.name = file.stem().string();
  if (document.kind != Value::Kind::kMap) {
    add_error(diagnostics, "config.wrong_type", {file.string(), 1, 1},
              "a configuration is a map of keys and values", "it starts with periost: 1");
    return configuration;
  }
  const auto top =
      std::any_cast<TopLevel>(top_level_table().decode(document, diagnostics, configuration.folder));
  if (document.find("name") != nullptr) configuration.name = top.name;
  if (!is_file_name(configuration.name)) {
    add_error(diagnostics, "config.bad_name", place_of(document, "name"),
              fmt::format("'{}' cannot be the name of a folder", configuration.name));
  }
  if (top.feedback && top.feedback->until != "pass") {
    add_error(diagnostics, "config.unknown_choice", place_of(document, "feedback"),
              fmt::format("key 'feedback.until': '{}' is not one of pass", top.feedback->until));
  }
  configuration.feedback = top.feedback;
  configuration.feedback_place = place_of(document, "feedback");
  configuration.plugins = top.plugins;
  configuration.provenance = top.provenance;
  configuration.seed = top.seed;
  decode_chain(top.chain.value, configuration, diagnostics);
  return configuration;
}

}  // namespace

Configuration parse_configuration(const std::string& text, const std::filesystem::path& file,
                                  const std::vector<std::string>& overrides, Diagnostics& diagnostics) {
  const std::size_t before = diagnostics.size();
  Value document = parse_yaml(text, file.string(), diagnostics);
  for (const std::string& override : overrides) apply_override(document, override, diagnostics);
  expand_environment(document, process_environment(), diagnostics);
  // What the parser gave up on would only raise false alarms about missing keys.
  const bool is_broken = diagnostics.size() != before && document.kind != Value::Kind::kMap;
  return is_broken ? Configuration{} : decode(document, file, diagnostics);
}

Configuration read_configuration(const std::filesystem::path& file, const std::vector<std::string>& overrides,
                                 Diagnostics& diagnostics) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) {
    add_error(diagnostics, "config.unreadable", {file.string(), 0, 0},
              std::filesystem::exists(file, ignored) ? "this is not a file" : "there is no such file");
    return {};
  }
  if (std::filesystem::file_size(file, ignored) > kLargestDocument) {
    add_error(diagnostics, "config.too_large", {file.string(), 0, 0},
              fmt::format("the file has more than {} bytes", kLargestDocument), "is it a configuration?");
    return {};
  }
  try {
    return parse_configuration(read_text(file), file, overrides, diagnostics);
  } catch (const Error& error) {
    add_error(diagnostics, "config.unreadable", {file.string(), 0, 0}, error.what(), error.hint());
    return {};
  }
}

std::vector<ParamInfo> top_level_params() {
  return top_level_table().params();
}

}  // namespace periost
