#pragma once
// A counter-based random generator: value k of stream (seed, piece) is a pure function of the three, so
// pieces can run in any order and on any thread and draw the same numbers.
#include <cstdint>

namespace periost {

class Random {
 public:
  Random(std::uint64_t seed, std::uint64_t piece) : key_(mix(seed ^ mix(piece + kGolden))) {}

  std::uint64_t next() { return mix(key_ + kGolden * ++counter_); }
  // Uniform in [0, bound); bound > 0. The bias of 2^-64 * bound is accepted.
  std::uint32_t below(std::uint32_t bound) {
    return static_cast<std::uint32_t>((static_cast<Wide>(next()) * bound) >> 64);
  }
  // Uniform in [0, 1) with 53 bits.
  double uniform() { return static_cast<double>(next() >> 11) * 0x1.0p-53; }

 private:
  __extension__ using Wide = unsigned __int128;
  static constexpr std::uint64_t kGolden = 0x9E3779B97F4A7C15ULL;
  // The finaliser of SplitMix64 (Steele, Lea and Flood 2014).
  static constexpr std::uint64_t mix(std::uint64_t z) {
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
    return z ^ (z >> 31);
  }

  std::uint64_t key_;
  std::uint64_t counter_ = 0;
};

}  // namespace periost
