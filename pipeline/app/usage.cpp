#include "pipeline/app/usage.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "pipeline/app/commands.h"
#include "pipeline/base/diagnostic.h"

namespace periost {
namespace {

std::string did_you_mean(const std::string& word, const std::vector<std::string>& names) {
  const std::string nearest = nearest_name(word, names);
  return nearest.empty() ? std::string() : fmt::format("; did you mean '{}'?", nearest);
}

std::vector<std::string> command_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    names.push_back(command->get_name());
  }
  return names;
}

std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

// The first of `arguments` behind the command's name that looks like an option and is none of the command's.
std::string unknown_option(const CLI::App& command, const std::vector<std::string>& arguments) {
  for (const std::string& argument : arguments) {
    if (argument.size() < 2 || argument[0] != '-') continue;
    std::string name = argument.substr(0, argument.find('='));
    if (command.get_option_no_throw(name) == nullptr) return name;
  }
  return {};
}

}  // namespace

CLI::App* add_command(CLI::App& app, const std::string& name, const std::string& summary,
                      const std::string& example) {
  CLI::App* command = app.add_subcommand(name, summary);
  command->footer("Example:\n  " + example);
  return command;
}

std::string usage_sentence(const CLI::App& app, const std::vector<std::string>& arguments,
                           const CLI::ParseError& error) {
  const std::vector<std::string> commands = command_names(app);
  const auto used = app.get_subcommands();
  if (used.empty()) {
    for (const std::string& argument : arguments) {
      if (argument.empty() || argument[0] == '-') continue;
      return fmt::format("unknown command '{}'{}", argument, did_you_mean(argument, commands));
    }
    const std::string option = unknown_option(app, arguments);
    if (!option.empty())
      return fmt::format("unknown option '{}'{}", option, did_you_mean(option, option_names(app)));
    return fmt::format("a command is missing: {}", fmt::join(commands, ", "));
  }
  const CLI::App& command = *used.front();
  const std::string option = unknown_option(command, arguments);
  if (!option.empty()) {
    return fmt::format("{}: unknown option '{}'{}", command.get_name(), option,
                       did_you_mean(option, option_names(command)));
  }
  std::string text = error.what();
  while (!text.empty() && (text.back() == '\n' || text.back() == '.')) text.pop_back();
  return fmt::format("{}: {}", command.get_name(), text);
}

}  // namespace periost
