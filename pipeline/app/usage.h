#pragma once
// What was wrong with a command line, as one sentence with the nearest name, instead of CLI11's own words and
// codes.
#include <string>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): the library's
class App;
class ParseError;
}  // namespace CLI

namespace periost {

// `arguments` as typed, without the program's name.
std::string usage_sentence(const CLI::App& app, const std::vector<std::string>& arguments,
                           const CLI::ParseError& error);

}  // namespace periost
