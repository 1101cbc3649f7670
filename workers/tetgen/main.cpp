// SPDX-License-Identifier: AGPL-3.0-or-later
// periost-tetgen: fills a closed triangulated surface with tetrahedra by TetGen. README.md has the formats.
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <new>
#include <string>

#include "workers/tetgen/frames.h"

namespace {

using periost_tetgen::Reply;
using periost_tetgen::Request;
using periost_tetgen::Status;

constexpr char kHelp[] =
    "periost-tetgen fills a closed triangulated surface with tetrahedra, by TetGen.\n"
    "\n"
    "  periost-tetgen --in SURFACE --out MESH [options]\n"
    "  periost-tetgen --pipe        one binary request on standard input, one reply on standard output\n"
    "\n"
    "  --max-radius-edge X   largest ratio of circumradius to shortest edge (1.4)\n"
    "  --min-dihedral DEG    smallest dihedral angle aimed at (10)\n"
    "  --max-volume V        largest volume of a tetrahedron (0: no limit)\n"
    "  --optimise DEG        dihedral angles above it are improved at the end (140)\n"
    "  --tolerance X         relative tolerance of the test for coplanar points (1e-8)\n"
    "  --split-surface       lets TetGen add points on the surface\n"
    "  --memory BYTES        limit of memory (0: none)\n"
    "  --time SECONDS        limit of processor time (0: none)\n"
    "\n"
    "Example: periost-tetgen --in femur.txt --out femur_mesh.txt --max-volume 8\n"
    "The exit code is 0 when a mesh was written, else the number of the reason (README.md).\n"
    "Licence: AGPL-3.0-or-later. TetGen is by Hang Si.\n";

constexpr int kReplyDescriptor = 3;

// Written from the signal handler, so it is complete before the signal can come.
struct {
  periost_tetgen::ReplyHeader header;
  char message[64];
  std::size_t bytes = 0;
} time_reply;

void on_time_limit(int) {
  if (time_reply.bytes > 0) {
    const ssize_t ignored = ::write(kReplyDescriptor, &time_reply, time_reply.bytes);
    static_cast<void>(ignored);
  }
  ::_exit(static_cast<int>(Status::kTimeLimit));
}

void prepare_time_reply() {
  const char* text = periost_tetgen::sentence(Status::kTimeLimit);
  const std::size_t length = std::min(std::strlen(text), sizeof time_reply.message);
  std::memcpy(time_reply.message, text, length);
  time_reply.header.status = static_cast<std::uint32_t>(Status::kTimeLimit);
  time_reply.header.message_bytes = static_cast<std::uint32_t>(length);
  time_reply.bytes = sizeof time_reply.header + length;
}

void limit_resources(const periost_tetgen::RequestHeader& header) {
#ifndef PERIOST_SANITIZED  // the sanitizers reserve terabytes of addresses
  if (header.memory_bytes > 0) {
    const rlimit limit{header.memory_bytes, header.memory_bytes};
    ::setrlimit(RLIMIT_AS, &limit);
  }
#endif
  if (header.cpu_seconds > 0) {
    // The soft limit raises a signal that is answered; the hard one would just kill.
    const auto seconds = static_cast<rlim_t>(std::ceil(header.cpu_seconds));
    const rlimit limit{seconds, seconds + 5};
    ::signal(SIGXCPU, on_time_limit);
    ::setrlimit(RLIMIT_CPU, &limit);
  }
}

Reply guarded_mesh(const Request& request) {
  try {
    return periost_tetgen::mesh(request);
  } catch (const std::bad_alloc&) {
    Reply reply;
    reply.status = Status::kMemory;
    reply.message = periost_tetgen::sentence(reply.status);
    return reply;
  }
}

[[noreturn]] void serve() {
  // An orphan would keep the processor busy for nobody.
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  // What TetGen prints goes where errors go; the reply has the standard output for itself.
  if (::dup2(STDOUT_FILENO, kReplyDescriptor) < 0 || ::dup2(STDERR_FILENO, STDOUT_FILENO) < 0) ::_exit(1);
  Request request;
  Reply reply;
  try {
    if (periost_tetgen::read_request(STDIN_FILENO, request)) {
      prepare_time_reply();
      limit_resources(request.header);
      reply = guarded_mesh(request);
    } else {
      reply.status = Status::kBadRequest;
      reply.message = "the request is incomplete or not a request";
    }
  } catch (const std::bad_alloc&) {
    reply.status = Status::kMemory;
    reply.message = periost_tetgen::sentence(reply.status);
  }
  std::fflush(stdout);
  ::_exit(periost_tetgen::write_reply(kReplyDescriptor, reply) ? 0 : 1);
}

int usage_error(const std::string& text) {
  std::fprintf(stderr, "periost-tetgen: %s (see --help)\n", text.c_str());
  return static_cast<int>(Status::kBadRequest);
}

// A number that is the whole of the text.
bool read_number(const char* text, double& value) {
  char* end = nullptr;
  value = std::strtod(text, &end);
  return end != text && *end == '\0' && std::isfinite(value) && value >= 0;
}

[[noreturn]] void run_from_files(const std::string& in, const std::string& out, Request& request) {
  const std::string fault = periost_tetgen::read_text_file(in, request);
  if (!fault.empty()) std::exit(usage_error(fault));
  limit_resources(request.header);
  const Reply reply = guarded_mesh(request);
  int code = static_cast<int>(reply.status);
  if (reply.status != Status::kDone) {
    std::fprintf(stderr, "periost-tetgen: %s\n", reply.message.c_str());
  } else if (const std::string trouble = periost_tetgen::write_text_file(out, reply); !trouble.empty()) {
    code = usage_error(trouble);
  }
  // Without TetGen's clean-up, which cannot be trusted after a failure.
  std::fflush(nullptr);
  ::_exit(code);
}

}  // namespace

int main(int argc, char** argv) {
  Request request;
  double memory = 0;
  const std::map<std::string, double*> numbers{{"--max-radius-edge", &request.header.max_radius_edge},
                                               {"--min-dihedral", &request.header.min_dihedral_deg},
                                               {"--max-volume", &request.header.max_volume},
                                               {"--optimise", &request.header.optimise_deg},
                                               {"--tolerance", &request.header.tolerance},
                                               {"--memory", &memory},
                                               {"--time", &request.header.cpu_seconds}};
  std::map<std::string, std::string> files{{"--in", ""}, {"--out", ""}};
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--help") return std::fputs(kHelp, stdout) < 0 ? 1 : 0;
    if (word == "--pipe") serve();
    if (word == "--split-surface") {
      request.header.flags &= ~periost_tetgen::kPreserveSurface;
      continue;
    }
    if (i + 1 == argc) return usage_error("'" + word + "' is unknown or lacks its value");
    const char* value = argv[++i];
    if (const auto file = files.find(word); file != files.end()) {
      file->second = value;
    } else if (const auto number = numbers.find(word); number == numbers.end()) {
      return usage_error("unknown option '" + word + "'");
    } else if (!read_number(value, *number->second)) {
      return usage_error("'" + word + "' wants a number, not '" + value + "'");
    }
  }
  request.header.memory_bytes = static_cast<std::uint64_t>(memory);
  if (files["--in"].empty() || files["--out"].empty()) return usage_error("--in and --out are needed");
  run_from_files(files["--in"], files["--out"], request);
}
