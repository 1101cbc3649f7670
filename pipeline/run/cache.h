#pragma once
// Results of stages under the run folder's .cache, by key. An entry is KEY.json (what the stage made) beside
// one HASH.artefact per output; KEY.json is written last, so a run that is killed at any moment leaves only
// whole entries. What is damaged or missing counts as absent.
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "pipeline/data/artefact.h"
#include "pipeline/run/manifest.h"

namespace periost {

// All that decides a stage's result.
struct StageKey {
  std::string stage;          // kind
  std::uint32_t version = 1;  // of the stage
  std::string origin;         // "built in" or the hash of the plugin that brought it
  std::string params;         // resolved, with input paths replaced by the hash of their content
  std::uint64_t seed = 0;
  std::string run_name;             // stages that write files only, whose names it is part of; else empty
  std::vector<std::string> inputs;  // keys of the stages behind the inputs, with port and output number
};

// The xxh3-128 of all members and of Periost's version.
std::string hash_of(const StageKey& key);

struct CacheEntry {
  std::vector<Artefact> outputs;
  std::vector<std::string> hashes;  // of the outputs
  std::vector<FileRecord> files;    // that the stage left in the output folder
};

class Cache {
 public:
  // `folder` is .cache, `output` the run folder that files of decks are relative to. Both exist.
  Cache(std::filesystem::path folder, std::filesystem::path output)
      : folder_(std::move(folder)), output_(std::move(output)) {}

  // The entry, if every artefact is whole and every file still has its content.
  std::optional<CacheEntry> find(const std::string& key) const;
  // Throws Error{kLimit} when it cannot be written. Fills in the hashes.
  void store(const std::string& key, CacheEntry& entry) const;
  // Removes all entries but those of `keys`.
  void keep_only(const std::set<std::string>& keys) const;

 private:
  std::filesystem::path folder_;
  std::filesystem::path output_;
};

}  // namespace periost
