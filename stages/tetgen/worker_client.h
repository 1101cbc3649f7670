#pragma once
// Runs periost-tetgen as a child process and talks to it through its standard input and output.
#include <chrono>
#include <string>
#include <vector>

#include "pipeline/base/context.h"
#include "pipeline/data/tet_mesh.h"
#include "workers/tetgen/protocol.h"
#include "workers/tetgen/size_grid.h"

namespace periost {

struct WorkerRequest {
  periost_tetgen::RequestHeader header;  // counts are filled in here
  std::vector<Vec3> points;
  std::vector<Triangle> triangles;
  std::vector<Vec3> holes;
  std::vector<Vec3> region_seeds;  // a point in each region; none: regions are not told apart
  periost_tetgen::SizeGrid sizes;  // may be empty
};

struct WorkerReply {
  periost_tetgen::Status status = periost_tetgen::Status::kUnknown;
  std::string message;
  bool has_crashed = false;  // ended by a signal that it raised itself, like an abort; status is kBug
  std::vector<Vec3> points;
  std::vector<Tetrahedron> tets;
  std::vector<std::uint32_t> seed_of_tet;  // which of request.region_seeds lies in its region
};

// Starts the worker, waits for its reply and for its end; at `deadline`, on cancellation and on any error the
// worker is killed. No zombie is left. Deadline and memory limit come back as a status.
// Throws Error{kExternal, "tetgen.worker_missing" | "tetgen.worker_died"}, Error{kInterrupted}.
WorkerReply run_worker(const WorkerRequest& request, std::chrono::steady_clock::time_point deadline,
                       const Context& context);

}  // namespace periost
