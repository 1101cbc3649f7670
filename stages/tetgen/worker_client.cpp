#include "stages/tetgen/worker_client.h"

#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "pipeline/base/error.h"

namespace periost {
namespace {

using periost_tetgen::ReplyHeader;
using periost_tetgen::Status;

constexpr char kProgram[] = "periost-tetgen";

class Descriptor {
 public:
  explicit Descriptor(int value = -1) : value_(value) {}
  ~Descriptor() { close(); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int value() const { return value_; }
  void reset(int value) {
    close();
    value_ = value;
  }
  void close() {
    if (value_ >= 0) ::close(value_);
    value_ = -1;
  }

 private:
  int value_;
};

[[noreturn]] void fail_to_start(const std::string& reason) {
  throw Error(ErrorKind::kExternal, "tetgen.worker_missing",
              fmt::format("TetGen's worker '{}' cannot be started: {}", kProgram, reason),
              "it is built beside periost and must stay in the same folder; `periost doctor` looks for it");
}

// The context's folder of workers, or the folder of the running program.
std::filesystem::path worker_path(const Context& context) {
  std::filesystem::path folder = context.workers;
  if (folder.empty()) {
    std::error_code ignored;
    folder = std::filesystem::read_symlink("/proc/self/exe", ignored).parent_path();
  }
  return folder / kProgram;
}

// The child process: killed and awaited at the end of the scope, whatever happens.
class Worker {
 public:
  explicit Worker(const Context& context) {
    int pair[2];
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair) != 0) fail_to_start(std::strerror(errno));
    channel_.reset(pair[0]);
    const Descriptor theirs(pair[1]);
    printed_.reset(::memfd_create("tetgen-output", MFD_CLOEXEC));
    spawn(worker_path(context), theirs.value());
  }
  ~Worker() {
    if (pid_ > 0) {
      ::kill(pid_, SIGKILL);
      wait();
    }
  }
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  int channel() const { return channel_.value(); }

  // The status that waitpid() gives.
  int wait() {
    int status = 0;
    while (::waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
    }
    pid_ = -1;
    return status;
  }

  // The last line that TetGen printed.
  std::string last_words() const {
    char text[4096];
    const off_t end = ::lseek(printed_.value(), 0, SEEK_END);
    const off_t begin = std::max<off_t>(0, end - static_cast<off_t>(sizeof text));
    const ssize_t got = ::pread(printed_.value(), text, sizeof text, begin);
    std::string words(text, got > 0 ? static_cast<std::size_t>(got) : 0);
    while (!words.empty() && std::isspace(static_cast<unsigned char>(words.back())) != 0) words.pop_back();
    const std::size_t line = words.rfind('\n');
    return line == std::string::npos ? words : words.substr(line + 1);
  }

 private:
  void spawn(const std::filesystem::path& program, int theirs) {
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    ::posix_spawn_file_actions_init(&actions);
    ::posix_spawnattr_init(&attributes);
    ::posix_spawn_file_actions_adddup2(&actions, theirs, STDIN_FILENO);
    ::posix_spawn_file_actions_adddup2(&actions, theirs, STDOUT_FILENO);
    ::posix_spawn_file_actions_adddup2(&actions, printed_.value(), STDERR_FILENO);
    sigset_t none;
    ::sigemptyset(&none);
    ::posix_spawnattr_setsigmask(&attributes, &none);
    ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
    std::string name = program.string(), option = "--pipe";
    char* arguments[] = {name.data(), option.data(), nullptr};
    const int trouble = ::posix_spawn(&pid_, name.c_str(), &actions, &attributes, arguments, environ);
    ::posix_spawn_file_actions_destroy(&actions);
    ::posix_spawnattr_destroy(&attributes);
    if (trouble == 0) return;
    pid_ = -1;
    fail_to_start(fmt::format("{} ({})", std::strerror(trouble), name));
  }

  pid_t pid_ = -1;
  Descriptor channel_;
  Descriptor printed_;
};

template <class T>
void append(std::string& bytes, const std::vector<T>& values) {
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
}

std::string encode(const WorkerRequest& request) {
  static_assert(sizeof(Vec3) == 24 && sizeof(Triangle) == 12 && sizeof(Tetrahedron) == 16);
  periost_tetgen::RequestHeader header = request.header;
  header.points = request.points.size();
  header.triangles = request.triangles.size();
  header.holes = request.holes.size();
  header.regions = request.region_seeds.size();
  for (std::size_t k = 0; k < 3; ++k) {
    header.size_origin[k] = request.sizes.origin[k];
    header.size_nodes[k] = request.sizes.nodes[k];
  }
  header.size_spacing = request.sizes.spacing;
  std::string bytes(reinterpret_cast<const char*>(&header), sizeof header);
  append(bytes, request.points);
  append(bytes, request.triangles);
  append(bytes, request.holes);
  append(bytes, request.region_seeds);
  append(bytes, request.sizes.values);
  return bytes;
}

template <class T>
void take(const char*& from, std::uint64_t count, std::vector<T>& values) {
  values.resize(count);
  if (count > 0) std::memcpy(static_cast<void*>(values.data()), from, count * sizeof(T));
  from += count * sizeof(T);
}

// False when the bytes are not one whole reply.
bool decode(const std::string& bytes, WorkerReply& reply) {
  ReplyHeader header;
  if (bytes.size() < sizeof header) return false;
  std::memcpy(&header, bytes.data(), sizeof header);
  const std::uint64_t left = bytes.size() - sizeof header;
  if (header.magic != periost_tetgen::kReplyMagic || header.points > left / sizeof(Vec3) ||
      header.tets > left / sizeof(Tetrahedron) || (header.regions != 0 && header.regions != header.tets) ||
      header.message_bytes + header.points * sizeof(Vec3) + header.tets * sizeof(Tetrahedron) +
              header.regions * sizeof(std::uint32_t) !=
          left) {
    return false;
  }
  const char* from = bytes.data() + sizeof header;
  reply.status = static_cast<Status>(header.status);
  reply.message.assign(from, header.message_bytes);
  from += header.message_bytes;
  take(from, header.points, reply.points);
  take(from, header.tets, reply.tets);
  take(from, header.regions, reply.seed_of_tet);
  for (const Tetrahedron& tet : reply.tets) {
    for (const Index corner : tet) {
      if (corner >= reply.points.size()) return false;
    }
  }
  return true;
}

enum class Talk { kEnded, kTimeOut };

// Sends what is left of `request` and collects the answer until the other side closes.
Talk talk(int channel, const std::string& request, std::string& reply,
          std::chrono::steady_clock::time_point deadline, const Context& context) {
  constexpr int kPollMs = 50;
  std::vector<char> buffer(std::size_t{1} << 18);
  std::size_t sent = 0;
  for (;;) {
    context.check_cancelled();
    if (std::chrono::steady_clock::now() >= deadline) return Talk::kTimeOut;
    const bool is_sending = sent < request.size();
    pollfd wait{channel, static_cast<short>(POLLIN | (is_sending ? POLLOUT : 0)), 0};
    if (::poll(&wait, 1, kPollMs) <= 0) continue;
    if (is_sending && (wait.revents & POLLOUT) != 0) {
      const ssize_t put =
          ::send(channel, request.data() + sent, request.size() - sent, MSG_NOSIGNAL | MSG_DONTWAIT);
      if (put > 0) sent += static_cast<std::size_t>(put);
      // The worker has gone; what it said before is still to be read.
      if (put < 0 && errno != EAGAIN && errno != EINTR) sent = request.size();
    }
    if ((wait.revents & (POLLIN | POLLHUP | POLLERR)) != 0) {
      const ssize_t got = ::recv(channel, buffer.data(), buffer.size(), MSG_DONTWAIT);
      if (got > 0) reply.append(buffer.data(), static_cast<std::size_t>(got));
      if (got == 0 || (got < 0 && errno != EAGAIN && errno != EINTR)) return Talk::kEnded;
    }
  }
}

bool is_own_crash(int signal) {
  return signal == SIGABRT || signal == SIGSEGV || signal == SIGFPE || signal == SIGBUS || signal == SIGILL;
}

// What became of a worker that left no reply.
WorkerReply post_mortem(int status, const std::string& last_words, const Context& context) {
  context.check_cancelled();
  const std::string words = last_words.empty() ? "" : fmt::format("; its last words: {}", last_words);
  WorkerReply reply;
  if (WIFSIGNALED(status) && is_own_crash(WTERMSIG(status))) {
    reply.status = Status::kBug;
    reply.has_crashed = true;
    reply.message = fmt::format("TetGen's worker crashed with signal {} ({}){}", WTERMSIG(status),
                                ::strsignal(WTERMSIG(status)), words);
    return reply;
  }
  const std::string how =
      WIFSIGNALED(status)
          ? fmt::format("was ended by signal {} ({})", WTERMSIG(status), ::strsignal(WTERMSIG(status)))
          : fmt::format("ended with code {} and no reply", WEXITSTATUS(status));
  throw Error(ErrorKind::kExternal, "tetgen.worker_died", fmt::format("TetGen's worker {}{}", how, words),
              "if the system was short of memory, give a limit with --memory or a coarser surface");
}

}  // namespace

WorkerReply run_worker(const WorkerRequest& request, std::chrono::steady_clock::time_point deadline,
                       const Context& context) {
  Worker worker(context);
  WorkerReply reply;
  std::string bytes;
  if (talk(worker.channel(), encode(request), bytes, deadline, context) == Talk::kTimeOut) {
    reply.status = Status::kTimeLimit;
    return reply;
  }
  const int status = worker.wait();
  if (decode(bytes, reply)) return reply;
  return post_mortem(status, worker.last_words(), context);
}

}  // namespace periost
