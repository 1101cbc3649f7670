#pragma once
// Runs a program and catches what it says, for tests of the command line.
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include <sys/types.h>

namespace periost::test {

struct ProcessOptions {
  std::filesystem::path folder;                    // working folder; empty: the caller's
  std::map<std::string, std::string> environment;  // added to the caller's
  std::uint64_t file_size_limit = 0;               // RLIMIT_FSIZE with SIGXFSZ ignored; 0: none
  std::function<void(pid_t)> meanwhile;            // called in the parent while the program runs
};

struct ProcessResult {
  int exit_code = 0;  // 128 + signal when a signal ended it
  std::string out;
  std::string err;
};

// Precondition: arguments[0] is the program. Throws std::runtime_error when it cannot be started.
ProcessResult run_process(const std::vector<std::string>& arguments, const ProcessOptions& options = {});

// The built program, `build/PRESET/bin/periost`.
std::string periost_program();

// A fresh empty folder under the system's temporary folder, removed with its content at the end.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }
  // Writes a file below the folder and returns its path.
  std::filesystem::path write(const std::string& name, const std::string& text) const;

 private:
  std::filesystem::path path_;
};

// Names of half-written files (".NAME.partial.EXT") below a folder.
std::vector<std::string> partial_files(const std::filesystem::path& folder);

}  // namespace periost::test
