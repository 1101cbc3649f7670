#include "pipeline/run/manifest.h"

#include <array>
#include <nlohmann/json.hpp>

#include "pipeline/run/resources.h"
#include "pipeline/run/versions.h"

namespace periost {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<const char*, 5> kStatusNames{"passed", "warned", "gate_failed", "failed", "interrupted"};

Json json_of(const FileRecord& record, const char* path_key) {
  return {{path_key, record.file}, {"bytes", record.bytes}, {"xxh128", record.xxh128}};
}

Json json_of(const OutputRecord& record) {
  Json output{{"kind", record.kind}};
  if (!record.file.empty()) output["file"] = record.file;
  output["xxh128"] = record.xxh128;
  output["facts"] = Json(record.facts);
  for (const FileRecord& file : record.files) output["files"].push_back(json_of(file, "file"));
  return output;
}

Json json_of(const StageRecord& record) {
  Json stage{{"id", record.id},
             {"kind", record.kind},
             {"wall_s", record.wall_s},
             {"cpu_s", record.cpu_s},
             {"peak_rss_bytes", record.peak_rss_bytes},
             {"cached", record.cached},
             {"outputs", Json::array()}};
  for (const OutputRecord& output : record.outputs) stage["outputs"].push_back(json_of(output));
  return stage;
}

Json json_of(const ErrorRecord& error) {
  return {{"code", error.code}, {"stage", error.stage}, {"text", error.text}, {"hint", error.hint}};
}

Json json_of(const Hint& hint) {
  Json object{{"round", hint.round}, {"stage", hint.stage}, {"parameter", hint.parameter}};
  if (hint.balls.empty()) {
    object["factor"] = hint.factor;
  } else {
    object["places"] = hint.balls.size();
  }
  object["reason"] = hint.reason;
  return object;
}

Json json_of(const RoundRecord& record) {
  Json round{{"round", record.round}, {"verdict", nullptr}};
  if (!record.verdict.empty()) round["verdict"] = record.verdict;
  round["failed_gates"] = record.failed_gates;
  round["best"] = record.is_best;
  if (!record.folder.empty()) round["folder"] = record.folder;
  round["hints"] = Json::array();
  for (const Hint& hint : record.hints) round["hints"].push_back(json_of(hint));
  round["changed"] = Json::object();
  for (const RoundChange& change : record.changed) round["changed"][change.key] = change.text;
  round["reason"] = record.reason;
  if (!record.stages.empty()) round["stages"] = Json::array();
  for (const StageRecord& stage : record.stages) round["stages"].push_back(json_of(stage));
  if (record.error) round["error"] = json_of(*record.error);
  if (!record.ended.empty()) round["ended"] = record.ended;
  return round;
}

// Words of the command that are paths are cut as inputs are; the rest stays as typed.
Json json_of_command(const Manifest& manifest) {
  Json command = Json::array({"periost"});
  for (const std::string& word : manifest.command) {
    const std::size_t equals = word.find('=');
    const std::size_t start = equals == std::string::npos ? 0 : equals + 1;
    const bool is_path = word.find('/', start) != std::string::npos;
    command.push_back(is_path ? word.substr(0, start) + provenance_path(word.substr(start), manifest.paths)
                              : word);
  }
  return command;
}

}  // namespace

std::string name_of(RunStatus status) {
  return kStatusNames[static_cast<std::size_t>(status)];
}

std::string provenance_path(const std::filesystem::path& path, Provenance::Paths paths) {
  switch (paths) {
    case Provenance::Paths::kFull:
      return path.string();
    case Provenance::Paths::kBasename:
      return path.has_filename() ? path.filename().string() : path.parent_path().filename().string();
    case Provenance::Paths::kNone:
      return {};
  }
  return {};
}

std::string manifest_json(const Manifest& manifest) {
  Json document{{"schema", "periost-run/1"},
                {"name", manifest.name},
                {"status", name_of(manifest.status)},
                {"exit_code", manifest.exit_code},
                {"version", version()},
                {"libraries", Json(library_versions())},
                {"command", json_of_command(manifest)},
                {"host", {{"cores", core_count()}, {"memory_bytes", machine_memory_bytes()}}},
                {"seed", manifest.seed},
                {"threads", manifest.threads},
                {"memory_limit_bytes", nullptr},
                {"started", manifest.started},
                {"wall_s", manifest.wall_s},
                {"peak_rss_bytes", manifest.peak_rss_bytes},
                {"inputs", Json::array()},
                {"stages", Json::array()},
                {"rounds", Json::array()},
                {"error", nullptr}};
  if (manifest.memory_bytes > 0) document["memory_limit_bytes"] = manifest.memory_bytes;
  for (const FileRecord& input : manifest.inputs) document["inputs"].push_back(json_of(input, "path"));
  for (const StageRecord& stage : manifest.stages) document["stages"].push_back(json_of(stage));
  for (const RoundRecord& round : manifest.rounds) document["rounds"].push_back(json_of(round));
  if (manifest.error) document["error"] = json_of(*manifest.error);
  return document.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

namespace {

void replace_all(std::string& text, const std::string& what, const std::string& by) {
  if (what.empty()) return;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size())) {
    text.replace(at, what.size(), by);
  }
}

}  // namespace

std::string without_paths(std::string text, const std::vector<std::filesystem::path>& files,
                          Provenance::Paths paths) {
  if (paths == Provenance::Paths::kFull) return text;
  for (const std::filesystem::path& file : files) {
    const std::string name = provenance_path(file, Provenance::Paths::kBasename);
    replace_all(text, file.string(), name);
    replace_all(text, file.parent_path().string() + "/", "");
    if (paths == Provenance::Paths::kNone) replace_all(text, name, "(input)");
  }
  return text;
}

}  // namespace periost
