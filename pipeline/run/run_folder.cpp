#include "pipeline/run/run_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <vector>

#include "pipeline/base/error.h"
#include "pipeline/base/file.h"

namespace periost {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

// The first line is fixed by the Cache Directory Tagging convention: backup programs skip the folder.
constexpr const char* kTagText =
    "Signature: 8a477f597d28d172789f06886806bc55\n# Results of Periost's stages, for periost run --resume.\n";
constexpr const char* kTagMark = "Periost";
// What a run leaves besides the files that run.json and the cache name.
constexpr std::array kOwnFiles{"run.json",      "quality.json", "report.html",
                               "events.ndjson", "config.yaml",  "hints.json"};

constexpr const char* kRounds = "rounds";

json parse_file(const fs::path& path) {
  std::ifstream file(path);
  return file ? json::parse(file, nullptr, false) : json();
}

std::string string_of(const json& object, const char* key) {
  const auto found = object.is_object() ? object.find(key) : object.end();
  return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

// A name that stays inside the folder: neither absolute nor climbing out, whatever a damaged file says.
bool stays_inside(const std::string& name) {
  const fs::path path(name);
  if (name.empty() || path.is_absolute()) return false;
  for (const fs::path& part : path) {
    if (part == "..") return false;
  }
  return true;
}

void add_manifest_files(const json& manifest, std::set<std::string>& files) {
  if (!manifest.is_object() || !manifest.contains("stages") || !manifest["stages"].is_array()) return;
  for (const json& stage : manifest["stages"]) {
    if (!stage.is_object() || !stage.contains("outputs") || !stage["outputs"].is_array()) continue;
    for (const json& output : stage["outputs"]) {
      files.insert(string_of(output, "file"));
      if (!output.is_object() || !output.contains("files") || !output["files"].is_array()) continue;
      for (const json& file : output["files"]) files.insert(string_of(file, "file"));
    }
  }
}

void add_cache_files(const fs::path& cache, std::set<std::string>& files) {
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(cache, ignored)) {
    if (entry.path().extension() != ".json") continue;
    const json record = parse_file(entry.path());
    if (!record.is_object() || !record.contains("files") || !record["files"].is_array()) continue;
    for (const json& file : record["files"]) files.insert(string_of(file, "file"));
  }
}

bool is_number(const std::string& name) {
  return !name.empty() && name.find_first_not_of("0123456789") == std::string::npos;
}

// All that lies in rounds/N, which is ours.
void add_round_files(const fs::path& folder, std::set<std::string>& files) {
  std::error_code ignored;
  for (const auto& round : fs::directory_iterator(folder / kRounds, ignored)) {
    if (!is_number(round.path().filename().string())) continue;
    for (const auto& file : fs::directory_iterator(round.path(), ignored)) {
      if (file.is_regular_file(ignored)) files.insert(file.path().lexically_relative(folder).string());
    }
  }
}

// Folders of rounds that hold nothing any more.
void remove_empty_rounds(const fs::path& folder) {
  std::error_code ignored;
  std::vector<fs::path> rounds;
  for (const auto& round : fs::directory_iterator(folder / kRounds, ignored)) rounds.push_back(round.path());
  for (const fs::path& round : rounds) {
    if (is_number(round.filename().string())) fs::remove(round, ignored);
  }
  fs::remove(folder / kRounds, ignored);
}

std::set<std::string> files_of_earlier_runs(const fs::path& folder) {
  std::set<std::string> files(kOwnFiles.begin(), kOwnFiles.end());
  add_round_files(folder, files);
  add_manifest_files(parse_file(folder / "run.json"), files);
  add_cache_files(folder / ".cache", files);
  std::erase_if(files, [](const std::string& name) { return !stays_inside(name); });
  return files;
}

// Half-written files of a run that was killed.
void remove_partial_files(const fs::path& folder) {
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename().string();
    if (name.front() == '.' && name.find(".partial") != std::string::npos) fs::remove(entry.path(), ignored);
  }
}

void check_existing(const fs::path& path, ExistingFolder existing) {
  if (existing == ExistingFolder::kRefuse) {
    throw Error(ErrorKind::kUsage, "run.folder_exists",
                fmt::format("the output folder '{}' exists", path.string()),
                "use --resume to go on in it, --force to replace the run in it, or --out for another folder");
  }
  const bool is_empty = fs::is_directory(path) && fs::is_empty(path);
  if (!is_empty && !is_run_folder(path)) {
    throw Error(ErrorKind::kUsage, "run.not_a_run_folder",
                fmt::format("'{}' holds files that are not of a run of Periost", path.string()),
                "choose another folder with --out");
  }
}

}  // namespace

bool is_run_folder(const fs::path& path) {
  std::ifstream tag(path / ".cache" / "CACHEDIR.TAG");
  const std::string text{std::istreambuf_iterator<char>(tag), {}};
  if (text.find(kTagMark) != std::string::npos) return true;
  return string_of(parse_file(path / "run.json"), "schema").rfind("periost-run/", 0) == 0;
}

RunFolder::RunFolder(fs::path path, ExistingFolder existing) : path_(std::move(path)) {
  if (fs::exists(path_)) check_existing(path_, existing);
  std::error_code failure;
  fs::create_directories(cache(), failure);
  const fs::path lock_path = cache() / "lock";
  lock_.value = ::open(lock_path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (lock_.value < 0) {
    throw Error(ErrorKind::kLimit, "file.unwritable",
                fmt::format("cannot create the output folder '{}': {}", path_.string(), std::strerror(errno)),
                "choose a folder that you may write to with --out");
  }
  if (::flock(lock_.value, LOCK_EX | LOCK_NB) != 0) {
    throw Error(ErrorKind::kUsage, "run.folder_busy",
                fmt::format("another run is writing to '{}'", path_.string()),
                "wait for it or choose another --out");
  }
  earlier_ = files_of_earlier_runs(path_);
  remove_partial_files(path_);
  remove_partial_files(cache());
  fs::remove_all(scratch(), failure);
  if (existing == ExistingFolder::kForce) {
    remove_stale({});
    for (const auto& entry : fs::directory_iterator(cache())) {
      if (entry.path() != lock_path) fs::remove_all(entry.path(), failure);
    }
  }
  // What an earlier run said no longer holds; a killed run must not leave the old verdict behind.
  for (const char* name : {"run.json", "quality.json", "report.html"}) fs::remove(path_ / name, failure);
  AtomicFile tag(cache() / "CACHEDIR.TAG");
  tag.write(std::string_view(kTagText));
  tag.commit();
  fs::create_directories(scratch(), failure);
}

RunFolder::~RunFolder() {
  std::error_code ignored;
  fs::remove_all(scratch(), ignored);
}

RunFolder::Descriptor::~Descriptor() {
  if (value >= 0) ::close(value);
}

void RunFolder::remove_stale(const std::set<std::string>& kept) const {
  std::error_code ignored;
  for (const std::string& name : earlier_) {
    if (!kept.contains(name)) fs::remove(path_ / name, ignored);
  }
  remove_empty_rounds(path_);
}

}  // namespace periost
