#include "pipeline/app/load_stages.h"

namespace periost {

void register_builtin_stages(Registry& registry);  // generated: stages/stage_list.cpp.in

void load_stages(Registry& registry, const Configuration& /*configuration*/, Diagnostics& /*diagnostics*/) {
  register_builtin_stages(registry);
}

}  // namespace periost
