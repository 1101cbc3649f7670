// periost schema: the JSON Schema of the whole configuration, for editors (yaml-language-server) and other
// tools.
#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "pipeline/app/commands.h"
#include "pipeline/app/load_stages.h"
#include "pipeline/base/error.h"
#include "pipeline/run/schema.h"

namespace periost {
namespace {

int print_schema() {
  Registry registry;
  Diagnostics diagnostics;
  load_stages(registry, {}, diagnostics);
  for (const Diagnostic& diagnostic : diagnostics) fmt::print(stderr, "{}\n", format(diagnostic));
  fmt::print("{}\n", configuration_schema(registry));
  return has_errors(diagnostics) ? exit_code(ErrorKind::kUsage) : 0;
}

}  // namespace

void add_schema_command(CLI::App& app, Session& session) {
  CLI::App* command = add_command(app, "schema", "Prints the JSON Schema of the configuration.",
                                  "periost schema > periost.schema.json");
  command->callback([&session] { session.exit_code = print_schema(); });
}

}  // namespace periost
