#include "pipeline/app/load_stages.h"

#include <cstdlib>

#include "pipeline/stage/plugin_loader.h"

namespace periost {

void register_builtin_stages(Registry& registry);  // generated: stages/stage_list.cpp.in

void load_stages(Registry& registry, const Configuration& configuration, Diagnostics& diagnostics) {
  register_builtin_stages(registry);
  const char* search_path = std::getenv("PERIOST_PLUGIN_PATH");
  load_plugins(configuration.plugins, search_path == nullptr ? "" : search_path, registry, diagnostics);
}

}  // namespace periost
