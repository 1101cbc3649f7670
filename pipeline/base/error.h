#pragma once
// Errors by kind. Algorithms throw them; the runner adds stage and artefact and turns them into a
// diagnostic and an exit code. A bug of our own is an assertion (PERIOST_ASSERT), never an Error.
#include <stdexcept>
#include <string>

namespace periost {

// What went wrong, in the terms of the command line's exit codes (docs/errors.md).
enum class ErrorKind {
  kInternal,     // our own fault: 1
  kUsage,        // command line, configuration, plugin: 2
  kQuality,      // a gate failed, or a surface of the chain's own making is unusable: 3
  kInput,        // a file or mesh that was read is missing, broken or lying: 4
  kExternal,     // TetGen's worker, CalculiX or Slurm failed: 5
  kLimit,        // memory, time or disk: 6
  kInterrupted,  // Ctrl-C or a termination signal: 130
};

// `code` is a stable dotted word ("image.truncated"); `what()` one sentence with the place in it; `hint` what
// to do about it, possibly empty.
class Error : public std::runtime_error {
 public:
  Error(ErrorKind kind, std::string code, const std::string& text, std::string hint = {})
      : std::runtime_error(text), kind_(kind), code_(std::move(code)), hint_(std::move(hint)) {}

  ErrorKind kind() const { return kind_; }
  const std::string& code() const { return code_; }
  const std::string& hint() const { return hint_; }

 private:
  ErrorKind kind_;
  std::string code_;
  std::string hint_;
};

// The exit code of the command-line contract for a kind.
int exit_code(ErrorKind kind);

[[noreturn]] void assertion_failed(const char* condition, const char* file, int line);

}  // namespace periost

// Checks an invariant of our own; active in every preset but release.
#ifdef PERIOST_ASSERTIONS
#define PERIOST_ASSERT(condition) \
  ((condition) ? static_cast<void>(0) : ::periost::assertion_failed(#condition, __FILE__, __LINE__))
#else
#define PERIOST_ASSERT(condition) static_cast<void>(0)
#endif
