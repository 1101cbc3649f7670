#pragma once
// The configuration as JSON Schema (draft 2020-12).
#include <string>

#include "pipeline/stage/registry.h"

namespace periost {

// The schema of a whole configuration with the stages of the registry, as indented JSON text. What it accepts
// is a superset of what the program accepts: ${ENV} and units are checked by patterns only where numbers
// stand.
std::string configuration_schema(const Registry& registry);

}  // namespace periost
