#pragma once
// Quantities with units, as users write them: `0.3 voxel`, `0.45 mm`, `20 deg`, `4GiB`.
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace periost {

// A length in millimetres, or in voxels of the largest side (the paper's unit).
struct Length {
  enum class Unit { kMillimetre, kVoxel };
  double value = 0;
  Unit unit = Unit::kMillimetre;

  static constexpr Length mm(double value) { return {value, Unit::kMillimetre}; }
  static constexpr Length voxel(double value) { return {value, Unit::kVoxel}; }
  // Millimetres, given the largest voxel side. Precondition: voxel_mm > 0 if the unit is the voxel.
  double in_mm(double voxel_mm) const { return unit == Unit::kVoxel ? value * voxel_mm : value; }
  friend bool operator==(const Length&, const Length&) = default;
};

// An angle in degrees.
struct Angle {
  double degrees = 0;
  static constexpr Angle deg(double degrees) { return {degrees}; }
  double radians() const { return degrees * 0.017453292519943295; }
  friend bool operator==(const Angle&, const Angle&) = default;
};

inline constexpr std::uint64_t kMiB = 1048576;  // bytes

// A size in bytes; 0 stands for "no limit" where a key allows it.
struct ByteSize {
  std::uint64_t bytes = 0;
  friend bool operator==(const ByteSize&, const ByteSize&) = default;
};

// What a parameter measures; it decides which units are accepted and what a bare number means.
enum class Quantity {
  kNone,        // not a measure: a name, a switch
  kCount,       // whole number
  kNumber,      // pure number
  kFraction,    // 0..1
  kLength,      // mm or voxel; bare: mm
  kAngle,       // deg or rad; bare: deg
  kIntensity,   // the image's own unit (HU)
  kVolume,      // mm^3
  kBytes,       // 4GiB, 500MB; bare numbers refused
  kSeconds,     // s
  kInputPath,   // a file or folder that is read: its content enters the cache key and run.json's inputs
  kOutputPath,  // a file that is written, relative to the output folder
};

// Each parser reads the whole text and returns nothing when it is not of the form. `text` may hold one blank
// between number and unit; unit names are case-sensitive.
std::optional<double> parse_number(std::string_view text);  // refuses leading zeros, nan, inf
std::optional<Length> parse_length(std::string_view text);  // "0.3 voxel", "0.45 mm", "0.45", "12 um", "1 cm"
std::optional<Angle> parse_angle(std::string_view text);    // "20 deg", "0.35 rad", "20"
std::optional<ByteSize> parse_byte_size(std::string_view text);  // "4GiB", "500MB"; bare numbers refused

// Shortest text that reads back to the same value.
std::string to_text(double value);
std::string to_text(const Length& length);
std::string to_text(const Angle& angle);
std::string to_text(const ByteSize& size);
std::string mebibytes(std::uint64_t bytes);  // "516 MiB", rounded, for messages

}  // namespace periost
