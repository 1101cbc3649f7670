#pragma once
// Versions of Periost and of the libraries it was built with, for --version and run.json.
#include <map>
#include <string>

namespace periost {

std::string version();
std::map<std::string, std::string> library_versions();

}  // namespace periost
