#pragma once
// The output folder of a run: taken with a lock, never mixed up with somebody else's files.
#include <filesystem>
#include <set>
#include <string>

namespace periost {

enum class ExistingFolder {
  kRefuse,  // a folder that exists is an error
  kResume,  // its cache is used, its files are replaced one by one
  kForce,   // what Periost made in it is removed first; other files stay
};

// True when `path` is a folder that a run made: it holds the tag file .cache/CACHEDIR.TAG or a run.json of
// our schema.
bool is_run_folder(const std::filesystem::path& path);

class RunFolder {
 public:
  // Creates and locks the folder. Throws Error{kUsage}: "run.folder_exists" (kRefuse), "run.not_a_run_folder"
  // (exists, not empty and not ours), "run.folder_busy" (another run holds the lock); Error{kLimit,
  // "file.unwritable"}.
  RunFolder(std::filesystem::path path, ExistingFolder existing);
  // Removes the scratch folder and releases the lock.
  ~RunFolder();
  RunFolder(const RunFolder&) = delete;
  RunFolder& operator=(const RunFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path cache() const { return path_ / ".cache"; }
  std::filesystem::path scratch() const { return cache() / "scratch"; }
  // Removes the files of earlier runs in this folder that are not in `kept` (names relative to the folder),
  // and the folders of rounds that are empty then.
  void remove_stale(const std::set<std::string>& kept) const;

 private:
  std::filesystem::path path_;
  std::set<std::string> earlier_;  // files that earlier runs left, as far as run.json and the cache tell
  struct Descriptor {
    int value = -1;
    ~Descriptor();
  };
  Descriptor lock_;
};

}  // namespace periost
