#pragma once
// Loads plugins (plugin.h) and refuses, in one sentence, those that do not fit.
#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/stage/registry.h"

namespace periost {

struct LoadedPlugin {
  std::filesystem::path file;
  std::string name, version, licence;
  std::vector<std::string> stages;
};

// Loads one library and adds its stages to the registry, all or none. It stays loaded until the program ends,
// since stages, options and errors made by it may outlive everything here. Throws Error{kUsage}:
// plugin.unreadable (missing or not a shared library), plugin.no_entry, plugin.wrong_magic,
// plugin.wrong_size, plugin.wrong_epoch, plugin.wrong_toolchain, plugin.register_failed (it threw),
// plugin.no_stage, plugin.duplicate_stage, plugin.bad_declaration.
LoadedPlugin load_plugin(const std::filesystem::path& file, Registry& registry);

// Loads the named libraries and those in `search_path` (PERIOST_PLUGIN_PATH: files and folders, separated by
// colons; of a folder all *.so, by name). A library named more than once is loaded once; a refusal is a
// diagnostic, and the others are loaded all the same.
std::vector<LoadedPlugin> load_plugins(const std::vector<std::filesystem::path>& files,
                                       const std::string& search_path, Registry& registry,
                                       Diagnostics& diagnostics);

}  // namespace periost
