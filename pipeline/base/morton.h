#pragma once
// The Morton curve through space: cells that follow one another along it are near one another.
#include <cstdint>

namespace periost {

// Spreads the low 21 bits so that two zero bits follow each; higher bits are left out.
inline std::uint64_t spread_bits(std::uint64_t x) {
  x &= 0x1FFFFF;
  x = (x | x << 32) & 0x1F00000000FFFFULL;
  x = (x | x << 16) & 0x1F0000FF0000FFULL;
  x = (x | x << 8) & 0x100F00F00F00F00FULL;
  x = (x | x << 4) & 0x10C30C30C30C30C3ULL;
  return (x | x << 2) & 0x1249249249249249ULL;
}

// The place of a cell along the curve, by the low 21 bits of its indices.
inline std::uint64_t morton_code(std::uint64_t i, std::uint64_t j, std::uint64_t k) {
  return spread_bits(i) | spread_bits(j) << 1 | spread_bits(k) << 2;
}

}  // namespace periost
