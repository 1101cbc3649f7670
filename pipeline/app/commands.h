#pragma once
// The commands of the program, one file each (NAME_command.cpp). A new command is a file here, its line
// below, and its line in main.cpp; commands that do not exist yet have no line, so --help never lists them.
//
//   void add_stages_command(CLI::App& app, Session& session) {
//     auto options = std::make_shared<StagesOptions>();
//     CLI::App* command = add_command(app, "stages", "Lists the stages and their parameters.",
//                                     "periost stages decimate --format json");
//     command->add_option("NAME", options->name, "Only this stage.");
//     command->callback([options, &session] { session.exit_code = list_stages(*options, session); });
//   }
//
// A callback may throw Error: main prints it as one sentence on standard error and ends with the exit code of
// its kind. Results go to standard output, everything else to standard error.
#include <filesystem>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace periost {

// What the commands share.
struct Session {
  std::filesystem::path program;       // the running executable; workers lie beside it
  std::vector<std::string> arguments;  // as typed, without the program's name
  int exit_code = 0;                   // set by the command's callback
};

// Adds a subcommand; its --help ends with `example`.
CLI::App* add_command(CLI::App& app, const std::string& name, const std::string& summary,
                      const std::string& example);

void add_run_command(CLI::App& app, Session& session);
void add_quality_command(CLI::App& app, Session& session);
void add_validate_command(CLI::App& app, Session& session);
void add_stages_command(CLI::App& app, Session& session);
void add_schema_command(CLI::App& app, Session& session);

}  // namespace periost
