#pragma once
// What a round of a run asks of the next one. The stage that judges makes hints; the framework hands them, in
// the next round, to every stage that takes them (an input of kind hints), and names no stage itself. Data
// still flows one way: a hint is a value that is only ever added to, never changed.
#include <cstdint>
#include <string>
#include <vector>

#include "pipeline/data/quality_report.h"
#include "pipeline/data/vec.h"

namespace periost {

// A place where edges shall be shorter.
struct HintBall {
  Vec3 centre_mm;        // LPS
  double radius_mm = 0;  // > 0
  double size_mm = 0;    // longest edge wanted within it, > 0
  friend bool operator==(const HintBall&, const HintBall&) = default;
};

// One wish, on one key of the stages of one kind. Either it is local (`balls`) or it is global (`factor`).
struct Hint {
  std::string stage;            // kind of the stages it is for
  std::string parameter;        // the key of theirs that it sharpens
  double factor = 1;            // on the configured value; 1 where the cause is local
  std::vector<HintBall> balls;  // where; empty where the cause is global
  std::string metric;           // of the gate that failed
  double value = 0, limit = 0;  // of that gate
  std::uint32_t round = 1;      // whose gate failed
  std::string reason;           // one sentence
  friend bool operator==(const Hint&, const Hint&) = default;
};

struct Hints {
  std::vector<Hint> hints;        // of all rounds so far, oldest first
  std::vector<RoundNote> rounds;  // how they ended
};

// Those for stages of one kind, in order; without the notes on rounds, which are nobody's parameter.
Hints addressed_to(const Hints& hints, const std::string& stage);

// The balls of all hints on a parameter, in order. Where they overlap the smallest size counts. `hints` may
// be null: no balls.
std::vector<HintBall> balls_on(const Hints* hints, const std::string& parameter);
// The smallest factor that a hint puts on a parameter, since each one is meant for the configured value; 1
// without hints or where `hints` is null.
double factor_on(const Hints* hints, const std::string& parameter);

}  // namespace periost
