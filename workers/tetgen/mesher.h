// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once
// TetGen behind one function that always returns.
#include <cstdint>
#include <string>
#include <vector>

#include "workers/tetgen/protocol.h"
#include "workers/tetgen/size_grid.h"

namespace periost_tetgen {

struct Request {
  RequestHeader header;
  std::vector<double> points;            // x y z
  std::vector<std::uint32_t> triangles;  // three indices from 0
  std::vector<double> holes;             // x y z, a point inside each cavity
  std::vector<double> regions;           // x y z, a point inside each region; may be empty
  SizeGrid sizes;                        // largest edges by place; may be empty
};

struct Reply {
  Status status = Status::kUnknown;
  std::string message;  // one sentence
  std::vector<double> points;
  std::vector<std::uint32_t> tets;
  std::vector<std::uint32_t> regions;  // per tetrahedron its region's seed, from 0; empty without seeds
};

// What a status means, as a sentence.
const char* sentence(Status status);

// Checks the numbers of a request: finite, indices in range. Empty when they are, else a sentence.
std::string fault_of(const Request& request);

// TetGen's switches for a request's header, as its manual names them.
std::string switches(const RequestHeader& header);

// Runs TetGen, which prints to the standard output. Not to be called twice in one process: TetGen keeps
// tables of the first call's size.
Reply mesh(const Request& request);

}  // namespace periost_tetgen
