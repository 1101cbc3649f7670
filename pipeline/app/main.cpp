// The command line: parses, runs one command, and turns every failure into one sentence and an exit code
// (docs/errors.md).
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <iostream>
#include <new>

#include "pipeline/app/commands.h"
#include "pipeline/app/usage.h"
#include "pipeline/base/error.h"
#include "pipeline/run/versions.h"

namespace periost {
namespace {

// One line per command: the order of --help.
void add_commands(CLI::App& app, Session& session) {
  add_run_command(app, session);
  add_quality_command(app, session);
  add_validate_command(app, session);
  add_stages_command(app, session);
  add_schema_command(app, session);
}

int fail(ErrorKind kind, const std::string& code, const std::string& text, const std::string& hint = {}) {
  fmt::print(stderr, "periost: error: {}{}{} [{}]\n", text, hint.empty() ? "" : "; ", hint, code);
  return exit_code(kind);
}

std::string version_text() {
  std::string text = fmt::format("periost {}\n", version());
  for (const auto& [name, number] : library_versions()) text += fmt::format("{} {}\n", name, number);
  text.pop_back();
  return text;
}

int parse_and_run(CLI::App& app, Session& session, int argc, char** argv) {
  try {
    app.parse(argc, argv);
    return session.exit_code;
  } catch (const CLI::Success& success) {
    return app.exit(success, std::cout, std::cerr);
  } catch (const CLI::ParseError& error) {
    return fail(ErrorKind::kUsage, "usage.command_line", usage_sentence(app, session.arguments, error),
                "see 'periost --help'");
  }
}

int run_program(int argc, char** argv) {
  Session session;
  std::error_code ignored;
  session.program = std::filesystem::canonical("/proc/self/exe", ignored);
  session.arguments.assign(argv + 1, argv + argc);

  CLI::App app{"From a CT to a finite-element mesh in one command.", "periost"};
  app.require_subcommand(1);
  app.set_version_flag("--version", version_text(), "Version of Periost and of its libraries.");
  app.footer("Every command has its own help: periost COMMAND --help");
  add_commands(app, session);
  return parse_and_run(app, session, argc, argv);
}

}  // namespace
}  // namespace periost

int main(int argc, char** argv) {
  using namespace periost;
  try {
    return run_program(argc, argv);
  } catch (const Error& error) {
    return fail(error.kind(), error.code(), error.what(), error.hint());
  } catch (const std::bad_alloc&) {
    return fail(ErrorKind::kLimit, "limit.memory", "there is not enough memory");
  } catch (const std::exception& error) {
    return fail(ErrorKind::kInternal, "internal.unexpected", fmt::format("unexpected: {}", error.what()),
                "this is a fault of Periost; please report it");
  }
}
