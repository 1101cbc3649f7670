// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The messages between Periost and periost-tetgen: one request, one reply, both a fixed header followed by
// arrays, in the byte order of the machine that both run on. README.md describes them; this is the layout.
#include <cstddef>
#include <cstdint>

namespace periost_tetgen {

inline constexpr std::uint64_t kRequestMagic = 0x32514552'47455450;  // "PTEGREQ2" in memory order
inline constexpr std::uint64_t kReplyMagic = 0x32504552'47455450;    // "PTEGREP2"

// Bits of RequestHeader::flags.
inline constexpr std::uint32_t kPreserveSurface = 1;

// Followed by points x 3 doubles, triangles x 3 uint32, holes x 3 doubles, regions x 3 doubles, and one float
// for each node of the grid of sizes (size_grid.h). Zero switches a limit off, and three times zero nodes the
// sizes.
struct RequestHeader {
  std::uint64_t magic = kRequestMagic;
  std::uint32_t flags = kPreserveSurface;
  std::uint32_t reserved = 0;
  double max_radius_edge = 1.4;  // of circumradius to shortest edge
  double min_dihedral_deg = 10;
  double max_volume = 0;
  double optimise_deg = 140;  // dihedral angles above it are worked on after refinement
  double tolerance = 1e-8;    // relative, of TetGen's test for coplanar points
  std::uint64_t memory_bytes = 0;
  double cpu_seconds = 0;
  std::uint64_t points = 0, triangles = 0, holes = 0, regions = 0;
  double size_origin[3] = {0, 0, 0};  // of the grid of sizes
  double size_spacing = 1;
  std::uint32_t size_nodes[3] = {0, 0, 0};
  std::uint32_t reserved_too = 0;
};

// How it ended; also the exit code of a run from files. 1 to 10 are TetGen's own numbers.
enum class Status : std::uint32_t {
  kDone = 0,
  kMemory = 1,
  kBug = 2,
  kSelfIntersection = 3,
  kTinyFeature = 4,
  kNearlyCoplanar = 5,
  kInput = 10,
  kTimeLimit = 20,
  kBadRequest = 21,
  kNothing = 22,  // not one tetrahedron: the surface encloses nothing
  kUnknown = 23,
};

// Followed by message_bytes of text (one sentence), points x 3 doubles, tets x 4 uint32. The points of the
// request come first, in its order; corners of a tetrahedron stand in VTK's order, with positive volume. If
// the request had regions, then regions x uint32, one per tetrahedron: the seed that lies in its region, from
// 0.
struct ReplyHeader {
  std::uint64_t magic = kReplyMagic;
  std::uint32_t status = 0;
  std::uint32_t message_bytes = 0;
  std::uint64_t points = 0, tets = 0, regions = 0;
};

static_assert(sizeof(RequestHeader) == 152 && sizeof(ReplyHeader) == 40, "the layout has no holes");

}  // namespace periost_tetgen
