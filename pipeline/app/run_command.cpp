// periost run: reads a configuration, checks the plan, executes it.
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <map>
#include <optional>

#include "pipeline/app/commands.h"
#include "pipeline/app/load_stages.h"
#include "pipeline/base/error.h"
#include "pipeline/run/artefact_files.h"
#include "pipeline/run/runner.h"
#include "pipeline/run/summary.h"

namespace periost {
namespace {

struct RunCommand {
  std::string config;
  std::vector<std::string> overrides;
  std::string out;
  int threads = 0;
  std::string memory;
  std::optional<std::uint64_t> seed;
  bool resume = false, force = false, dry_run = false, keep_going = false, verbose = false, quiet = false;
  ProgressStyle progress = ProgressStyle::kAuto;
  LogFormat log_format = LogFormat::kText;
  std::vector<std::string> save;
};

// Set by the first signal and polled by the run; the second signal ends the process at once.
std::atomic<bool>& cancel_flag() {
  static std::atomic<bool> flag{false};
  return flag;
}

void on_signal(int /*signal*/) {
  static volatile std::sig_atomic_t count = 0;
  count = count + 1;
  if (count > 1) ::_exit(exit_code(ErrorKind::kInterrupted));
  cancel_flag().store(true);
}

void listen_to_signals() {
  cancel_flag();  // made before a handler may need it
  struct sigaction action {};
  action.sa_handler = on_signal;
  action.sa_flags = SA_RESTART;
  ::sigaction(SIGINT, &action, nullptr);
  ::sigaction(SIGTERM, &action, nullptr);
  std::signal(SIGPIPE, SIG_IGN);  // a worker that dies, or a closed terminal, is an error of a write
  std::signal(SIGXFSZ, SIG_IGN);  // likewise a limit on the size of files
}

std::uint64_t memory_of(const std::string& text) {
  if (text.empty()) return 0;
  const auto size = parse_byte_size(text);
  if (!size || size->bytes == 0) {
    throw Error(ErrorKind::kUsage, "usage.bad_size", fmt::format("--memory: '{}' is not a size", text),
                "write it with its unit, as 4GiB or 500MB");
  }
  return size->bytes;
}

std::set<ArtefactKind> saved_kinds(const std::vector<std::string>& names) {
  const std::vector<std::string> known = saveable_kinds();
  std::set<ArtefactKind> kinds;
  for (const std::string& name : names) {
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      throw Error(ErrorKind::kUsage, "usage.unknown_kind", fmt::format("--save: unknown kind '{}'", name),
                  fmt::format("known are {}", fmt::join(known, ", ")));
    }
    kinds.insert(*kind_from_name(name));
  }
  return kinds;
}

RunOptions options_of(const RunCommand& command, const Plan& plan, const Session& session) {
  RunOptions options;
  options.output =
      command.out.empty() ? std::filesystem::path("runs") / plan.name : std::filesystem::path(command.out);
  if (command.resume) options.existing = ExistingFolder::kResume;
  if (command.force) options.existing = ExistingFolder::kForce;
  options.threads = command.threads;
  options.memory_bytes = memory_of(command.memory);
  options.keep_going = command.keep_going;
  options.save = saved_kinds(command.save);
  options.workers = session.program.parent_path();
  options.command = session.arguments;
  return options;
}

// Preflight already opens the inputs: when they alone are at fault, that is no fault of the configuration.
int exit_code_of(const Diagnostics& diagnostics) {
  const auto is_of_input = [](const Diagnostic& diagnostic) {
    const std::string group = diagnostic.code.substr(0, diagnostic.code.find('.'));
    return diagnostic.severity != Severity::kError || group == "image" || group == "mask" ||
           group == "surface" || group == "mesh" || group == "file";
  };
  const bool is_input = std::all_of(diagnostics.begin(), diagnostics.end(), is_of_input);
  return exit_code(is_input ? ErrorKind::kInput : ErrorKind::kUsage);
}

int execute(const RunCommand& command, const Session& session) {
  memory_of(command.memory);
  saved_kinds(command.save);
  Diagnostics diagnostics;
  Configuration configuration = read_configuration(command.config, command.overrides, diagnostics);
  if (command.seed) configuration.seed = *command.seed;
  Registry registry;
  load_stages(registry, configuration, diagnostics);
  const Plan plan = make_plan(configuration, registry, diagnostics);
  if (!command.quiet || has_errors(diagnostics)) {
    for (const Diagnostic& diagnostic : diagnostics) fmt::print(stderr, "{}\n", format(diagnostic));
  }
  if (has_errors(diagnostics)) return exit_code_of(diagnostics);

  const RunOptions options = options_of(command, plan, session);
  if (command.dry_run) {
    check_memory(plan, options.memory_bytes);
    fmt::print("{}", plan_table(plan));
    return 0;
  }
  const Verbosity verbosity = command.verbose ? Verbosity::kVerbose
                              : command.quiet ? Verbosity::kQuiet
                                              : Verbosity::kNormal;
  Reporter reporter({command.progress, command.log_format, verbosity});
  listen_to_signals();
  const Manifest manifest = run_plan(plan, registry, options, reporter, cancel_flag());
  fmt::print("{}", run_table(manifest, options.output));
  return manifest.exit_code;
}

template <class E>
CLI::Option* add_choice(CLI::App& command, const std::string& name, E& value,
                        const std::map<std::string, E>& names, const std::string& doc) {
  std::vector<std::string> words;
  for (const auto& [word, choice] : names) words.push_back(word);
  return command
      .add_option_function<std::string>(
          name, [&value, names](const std::string& word) { value = names.at(word); }, doc)
      ->check(CLI::IsMember(words))
      ->type_name(fmt::format("{}", fmt::join(words, "|")));
}

void add_options(CLI::App& app, RunCommand& command) {
  app.add_option("CONFIG", command.config, "The configuration (YAML).")->required();
  app.add_option("--set", command.overrides, "Overrides a key: decimate.distance=0.3voxel. May be repeated.")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  app.add_option("--out", command.out, "Output folder; runs/NAME by default.")->type_name("DIR");
  app.add_option("--threads", command.threads, "Threads; all cores by default. Results do not depend on it.")
      ->check(CLI::Range(0, 4096))
      ->type_name("N");
  app.add_option("--memory", command.memory, "Memory that may be used: 4GiB, 500MB.")->type_name("SIZE");
  app.add_option("--seed", command.seed, "Seed of every random choice; that of the configuration by default.")
      ->type_name("N");
  auto* resume =
      app.add_flag("--resume", command.resume, "Goes on in an existing folder, reusing what is complete.");
  app.add_flag("--force", command.force, "Replaces the run in an existing folder.")->excludes(resume);
  app.add_flag("--dry-run", command.dry_run, "Checks the plan and prints it; reads no voxel.");
  app.add_flag("--keep-going", command.keep_going,
               "Runs the stages behind a failed gate, too; still exits 3.");
  add_choice<ProgressStyle>(app, "--progress", command.progress,
                            {{"auto", ProgressStyle::kAuto},
                             {"bar", ProgressStyle::kBar},
                             {"plain", ProgressStyle::kPlain},
                             {"none", ProgressStyle::kNone}},
                            "How progress is shown on standard error.");
  add_choice<LogFormat>(app, "--log-format", command.log_format,
                        {{"text", LogFormat::kText}, {"json", LogFormat::kJson}},
                        "Form of the log on standard error.");
  auto* verbose = app.add_flag("--verbose", command.verbose, "Also says what happens in detail.");
  app.add_flag("--quiet", command.quiet, "Only warnings and errors.")->excludes(verbose);
  app.add_option("--save", command.save,
                 fmt::format("Also leaves these: {}.", fmt::join(saveable_kinds(), ", ")))
      ->type_name("KIND[,KIND]")
      ->delimiter(',')
      ->allow_extra_args(false);
}

}  // namespace

void add_run_command(CLI::App& app, Session& session) {
  auto command = std::make_shared<RunCommand>();
  CLI::App* run =
      add_command(app, "run", "Runs a chain, from its configuration to its last artefact.",
                  "periost run configs/cranium.yaml --set decimate.distance=0.3voxel --out runs/cranium");
  add_options(*run, *command);
  run->callback([command, &session] { session.exit_code = execute(*command, session); });
}

}  // namespace periost
