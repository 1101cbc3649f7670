#pragma once
// ${ENV} in the texts of a document.
#include <functional>
#include <optional>
#include <string>

#include "pipeline/base/diagnostic.h"
#include "pipeline/param/value.h"

namespace periost {

using Environment = std::function<std::optional<std::string>(const std::string&)>;

// The variables of this process.
Environment process_environment();

// Replaces ${NAME} in every scalar (keys stay), once: what a variable holds is not expanded again. `$${`
// stands for
// `${`. An undefined variable is an error (config.undefined_variable), a `${` without its name or brace, too
// (config.syntax).
void expand_environment(Value& document, const Environment& environment, Diagnostics& diagnostics);

}  // namespace periost
