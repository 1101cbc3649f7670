#pragma once
// run.json, schema periost-run/1: what a run was given, what it did and how it ended. No name of a person, no
// birth date and no identifier is ever part of it; paths as far as Provenance::Paths allows.
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/config/configuration.h"
#include "pipeline/data/hints.h"

namespace periost {

enum class RunStatus { kPassed, kWarned, kGateFailed, kFailed, kInterrupted };

// A file pinned by its content.
struct FileRecord {
  std::string file;  // relative to the output folder, or an input's path
  std::uint64_t bytes = 0;
  std::string xxh128;
  friend bool operator==(const FileRecord&, const FileRecord&) = default;
};

// One artefact that a stage made. `xxh128` is the hash of `file` where there is one, else of the artefact's
// value.
struct OutputRecord {
  std::string kind;
  std::string file{};  // empty: not left as a file
  std::string xxh128{};
  std::map<std::string, double> facts{};
  std::vector<FileRecord> files{};  // decks: the files they consist of
};

struct StageRecord {
  std::string id, kind;
  double wall_s = 0, cpu_s = 0;
  std::uint64_t peak_rss_bytes = 0;
  bool cached = false;
  std::vector<OutputRecord> outputs{};
};

struct ErrorRecord {
  std::string code, stage, text, hint;
};

// One round of feedback; a run without feedback that judges has one.
struct RoundRecord {
  std::uint32_t round = 1;
  std::string verdict;                    // "pass", "warn", "fail"; empty: it did not come to a verdict
  std::vector<std::string> failed_gates;  // their metrics
  bool is_best = false;                   // its artefacts lie at the top of the folder
  std::string folder;                     // "rounds/1"; empty: there was one round only
  std::vector<Hint> hints;                // that it ran with
  std::vector<RoundChange> changed;       // what it changes for the next round
  std::string reason;                     // why
  std::vector<StageRecord> stages;  // that it ran, cached ones included; files by their place in `folder`
  std::optional<ErrorRecord> error;
  std::string ended;  // the last round only: "pass", "no_improvement", "max_rounds", "error", "interrupted"
};

struct Manifest {
  std::string name;
  RunStatus status = RunStatus::kPassed;
  int exit_code = 0;
  std::vector<std::string> command;
  Provenance::Paths paths = Provenance::Paths::kBasename;
  std::uint64_t seed = 0;
  int threads = 1;
  std::uint64_t memory_bytes = 0;  // the budget; 0: none
  std::string started;
  double wall_s = 0;
  std::uint64_t peak_rss_bytes = 0;
  std::vector<FileRecord> inputs;
  std::vector<StageRecord> stages;  // with feedback: those of the best round, and those that ran once
  std::vector<RoundRecord> rounds;
  std::optional<ErrorRecord> error;
};

// "passed", "warned", "gate_failed", "failed", "interrupted".
std::string name_of(RunStatus status);

// The document, with two blanks of indentation. Versions, cores and memory of the machine are added.
std::string manifest_json(const Manifest& manifest);

// `path` as provenance allows: whole, its last part, or "".
std::string provenance_path(const std::filesystem::path& path, Provenance::Paths paths);

// `text` with every occurrence of one of `files` (full paths) cut likewise; kNone also hides their last
// parts.
std::string without_paths(std::string text, const std::vector<std::filesystem::path>& files,
                          Provenance::Paths paths);

}  // namespace periost
