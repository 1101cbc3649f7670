#include "pipeline/run/cache.h"

#include <fstream>
#include <nlohmann/json.hpp>

#include "pipeline/base/error.h"
#include "pipeline/base/file.h"
#include "pipeline/base/hash.h"
#include "pipeline/io/archive.h"
#include "pipeline/run/versions.h"

namespace periost {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* kSchema = "periost-cache/1";

bool has_content(const fs::path& path, const FileRecord& record) {
  std::error_code missing;
  if (fs::file_size(path, missing) != record.bytes || missing) return false;
  try {
    return hash_file(path) == record.xxh128;
  } catch (const Error&) {
    return false;
  }
}

// The description of an entry, or nothing if it is not of our form.
json read_record(const fs::path& path) {
  std::ifstream file(path);
  json record = file ? json::parse(file, nullptr, false) : json();
  return record.is_object() && record.value("schema", "") == kSchema ? record : json();
}

}  // namespace

std::string hash_of(const StageKey& key) {
  Hasher hasher;
  hasher.add(kSchema).add(version()).add(key.stage).add(std::to_string(key.version)).add(key.origin);
  hasher.add(key.params).add(std::to_string(key.seed)).add(key.run_name);
  for (const std::string& input : key.inputs) hasher.add(input);
  return hasher.hex();
}

std::optional<CacheEntry> Cache::find(const std::string& key) const {
  try {
    const json record = read_record(folder_ / (key + ".json"));
    if (record.is_null()) return std::nullopt;
    CacheEntry entry;
    for (const json& file : record.at("files")) {
      entry.files.push_back({file.at("file"), file.at("bytes"), file.at("xxh128")});
      if (!has_content(output_ / entry.files.back().file, entry.files.back())) return std::nullopt;
    }
    for (const json& output : record.at("outputs")) {
      const auto kind = kind_from_name(output.at("kind").get<std::string>());
      const std::string hash = output.at("xxh128");
      if (!kind) return std::nullopt;
      auto artefact = load_artefact(folder_ / (hash + ".artefact"), *kind, hash);
      if (!artefact) return std::nullopt;
      entry.outputs.push_back(std::move(*artefact));
      entry.hashes.push_back(hash);
    }
    return entry;
  } catch (const json::exception&) {
    return std::nullopt;
  }
}

void Cache::store(const std::string& key, CacheEntry& entry) const {
  json record{{"schema", kSchema}, {"outputs", json::array()}, {"files", json::array()}};
  entry.hashes.clear();
  for (const Artefact& artefact : entry.outputs) {
    const std::string hash = hash_artefact(artefact);
    save_artefact(artefact, folder_ / (hash + ".artefact"));
    record["outputs"].push_back({{"kind", name_of(kind_of(artefact))}, {"xxh128", hash}});
    entry.hashes.push_back(hash);
  }
  for (const FileRecord& file : entry.files) {
    record["files"].push_back({{"file", file.file}, {"bytes", file.bytes}, {"xxh128", file.xxh128}});
  }
  AtomicFile file(folder_ / (key + ".json"));
  file.write(record.dump(1) + "\n");
  file.commit();
}

void Cache::keep_only(const std::set<std::string>& keys) const {
  std::set<std::string> kept;
  for (const std::string& key : keys) {
    kept.insert(key + ".json");
    const json record = read_record(folder_ / (key + ".json"));
    if (!record.is_object() || !record.contains("outputs")) continue;
    for (const json& output : record["outputs"]) kept.insert(output.value("xxh128", "") + ".artefact");
  }
  std::error_code ignored;
  for (const auto& file : fs::directory_iterator(folder_, ignored)) {
    const std::string extension = file.path().extension().string();
    const bool is_entry = extension == ".json" || extension == ".artefact";
    if (is_entry && !kept.contains(file.path().filename().string())) fs::remove(file.path(), ignored);
  }
}

}  // namespace periost
