#pragma once
// Rounds of feedback: which one is best, when they end, and where their files lie.
//
// Files. While there is one round its files lie at the top of the run folder, as without feedback. When a
// second one starts, rounds/1 gets them, too; every further round writes into its own folder rounds/N from
// the start. Whenever a round turns out best, the top of the folder gets its files: so the top always holds
// one whole round, whatever happens to the next. Files that are at two places are hard links where the file
// system allows, so that they take no space twice.
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/data/quality_report.h"
#include "pipeline/run/manifest.h"

namespace periost {

// How good a round is.
struct RoundScore {
  bool is_judged = false;   // a quality report was made
  bool has_failed = false;  // one of them fails
  bool has_warned = false;  // one of them warns
  std::size_t reached = 0;  // steps before the first failed report; all without one
  std::size_t failed = 0;   // gates
  double shortfall = 0;     // sum over the failed gates of |value - limit| / |limit| (limit 0: |value|)
  std::size_t warned = 0;   // gates
  std::vector<std::string> failed_metrics;
};

// Adds a report of step number `step` to the score of a round.
void add_report(const QualityReport& report, std::size_t step, RoundScore& score);

// The order of rounds, best first: further down the chain before a gate failed, fewer failed gates, smaller
// shortfall, fewer warnings. A round that is equal in all is not better.
bool is_better(const RoundScore& a, const RoundScore& b);

// So many rounds in a row that are no better than the best before them end the loop.
inline constexpr std::uint32_t kFruitlessRounds = 2;

// What the end of a round is told.
struct RoundEnd {
  std::uint32_t round = 1, best = 1, max_rounds = 1;
  bool has_passed = false;     // no gate failed
  bool has_new_hints = false;  // it asks for something that it did not have
};
// Why no further round is to run: "pass"; "max_rounds"; "no_improvement" when the round asks for nothing new,
// or when it and the one before were no better than the best. Empty: go on.
std::string reason_to_end(const RoundEnd& end);

// "rounds/3".
std::string round_folder(std::uint32_t round);

// Names of the files that these stages left, relative to their round's folder.
std::vector<std::string> files_of(const std::vector<StageRecord>& stages);

// Puts the named files of folder `from` into folder `to`, each whole or not at all, in place of what has its
// name there; as hard links, or copies where that does not work. Throws Error{kLimit, "file.unwritable"}.
void put_files(const std::vector<std::string>& names, const std::filesystem::path& from,
               const std::filesystem::path& to);

}  // namespace periost
