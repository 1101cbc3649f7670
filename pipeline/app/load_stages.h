#pragma once
// All the stages that a command may use: those linked in and those of plugins.
#include "pipeline/config/configuration.h"
#include "pipeline/stage/registry.h"

namespace periost {

// Fills an empty registry with the stages that are linked in, those of the configuration's `plugins:` and
// those of PERIOST_PLUGIN_PATH. A plugin that is refused is a diagnostic.
void load_stages(Registry& registry, const Configuration& configuration, Diagnostics& diagnostics);

}  // namespace periost
