#pragma once
// A message to the user with a place. Diagnostics are collected and shown together; nothing stops at the
// first.
#include <string>
#include <vector>

namespace periost {

enum class Severity { kNote, kWarning, kError };

// A position in a text file; line and column count from 1, 0 means unknown.
struct SourcePlace {
  std::string file;
  int line = 0;
  int column = 0;
};

struct Diagnostic {
  Severity severity = Severity::kError;
  std::string code;   // stable dotted word, "config.unknown_key"
  std::string stage;  // id of the stage concerned, or empty
  std::string key;    // path of the key concerned, or empty
  SourcePlace place;
  std::string text;  // one sentence without a full stop
  std::string hint;  // what to do, or empty
};

using Diagnostics = std::vector<Diagnostic>;

bool has_errors(const Diagnostics& diagnostics);

// One line: `FILE:LINE:COL: error: stage 'decimate': unknown key 'distnce'; did you mean 'distance'? [code]`.
std::string format(const Diagnostic& diagnostic);

// The candidate nearest to `word` by edit distance, or empty when none is near (more than a third of its
// letters differ).
std::string nearest_name(const std::string& word, const std::vector<std::string>& candidates);

}  // namespace periost
