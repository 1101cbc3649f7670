// periost quality: measures any surface or tetrahedral mesh, ours or not.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <thread>
#include <variant>

#include "pipeline/app/commands.h"
#include "pipeline/base/error.h"
#include "pipeline/base/quantity.h"
#include "pipeline/geometry/gates.h"
#include "pipeline/geometry/measure_volume.h"
#include "pipeline/io/mesh_read.h"
#include "pipeline/io/quality_json.h"
#include "pipeline/mechanics/fitness.h"

namespace periost {
namespace {

struct QualityCommand {
  std::string mesh, reference, preset = "none", mechanics = "none", format = "text";
  std::vector<std::string> gates;
};

// A volume stands for the surface that bounds it.
SurfaceMesh surface_of(AnyMesh mesh) {
  if (const auto* tets = std::get_if<TetMesh>(&mesh)) return boundary_surface(*tets);
  return std::get<SurfaceMesh>(std::move(mesh));
}

// `PATH=LIMIT`, as in `volume.min_dihedral_deg.min=8`.
GateOverrides gates_of(const std::vector<std::string>& texts) {
  GateOverrides gates;
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    const std::string path = text.substr(0, equals);
    if (find_metric(path) == nullptr) {
      const std::string nearest = nearest_metric(path);
      throw Error(
          ErrorKind::kUsage, "verify.unknown_metric", fmt::format("unknown metric '{}'", path),
          nearest.empty() ? "docs/quality.md lists the metrics" : fmt::format("did you mean '{}'?", nearest));
    }
    const auto limit = equals == std::string::npos ? std::nullopt : parse_number(text.substr(equals + 1));
    if (!limit) {
      throw Error(ErrorKind::kUsage, "usage.command_line", fmt::format("--gate '{}' gives no limit", text),
                  "write it as surface.min_angle_deg.min=15");
    }
    gates[path].limit = limit;
  }
  return gates;
}

void print_text(const QualityReport& report) {
  for (const Metric& metric : metrics()) {
    const std::optional<double> value = metric.value(report);
    if (value) fmt::print("{:<52} {:>14.6g} {}\n", metric.path, *value, metric.unit);
  }
  for (const GateResult& gate : report.gates) {
    if (gate.status != Verdict::kPass) fmt::print("{}: {}\n", name_of(gate.status), describe(gate));
  }
  if (!report.gates.empty()) fmt::print("verdict: {}\n", name_of(report.verdict));
}

int measure(const QualityCommand& command) {
  const std::optional<Preset> preset = preset_from_name(command.preset);
  const GateOverrides gates = gates_of(command.gates);
  const AnyMesh mesh = read_mesh(command.mesh);
  QualityInputs inputs;
  SurfaceMesh boundary, reference;
  if (const auto* tets = std::get_if<TetMesh>(&mesh)) {
    boundary = boundary_surface(*tets);
    inputs.tet_mesh = tets;
    inputs.surface = &boundary;
  } else {
    inputs.surface = &std::get<SurfaceMesh>(mesh);
  }
  if (!command.reference.empty()) {
    reference = surface_of(read_mesh(command.reference));
    inputs.isosurface = &reference;
  }
  Context context;
  context.threads = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  context.sink = [](const Event& event) {
    if (event.level == Event::Level::kWarning) fmt::print(stderr, "periost: warning: {}\n", event.text);
  };
  Measurement measurement = measure_quality(inputs, {}, context);
  if (command.mechanics == "basic" && inputs.tet_mesh != nullptr) {
    measurement.report.mechanics = measure_fitness(*inputs.tet_mesh, context, measurement.worst);
  }
  apply_gates(measurement.report, measurement.worst, *preset, gates);
  if (command.format == "json") {
    fmt::print("{}", quality_json(measurement.report));
  } else {
    print_text(measurement.report);
  }
  return measurement.report.verdict == Verdict::kFail ? exit_code(ErrorKind::kQuality) : 0;
}

}  // namespace

void add_quality_command(CLI::App& app, Session& session) {
  auto options = std::make_shared<QualityCommand>();
  CLI::App* command =
      add_command(app, "quality", "Measures a surface or a tetrahedral mesh.",
                  "periost quality volume.vtu --reference isosurface.vtp --preset fe-standard");
  command->add_option("MESH", options->mesh, mesh_extensions())->required();
  command->add_option("--reference", options->reference,
                      "Surface, or volume for its boundary, that distances are measured to.");
  command->add_option("--preset", options->preset, "Gates to apply: none, lenient, fe-standard, fe-strict.")
      ->check(CLI::IsMember({"none", "lenient", "fe-standard", "fe-strict"}));
  command
      ->add_option("--mechanics", options->mechanics,
                   "Look at a tetrahedral mesh as a solver would, too: none, basic.")
      ->check(CLI::IsMember({"none", "basic"}));
  command->add_option("--gate", options->gates, "One more gate, METRIC=LIMIT; may be repeated.");
  command->add_option("--format", options->format, "text or json (schema periost-quality/1).")
      ->check(CLI::IsMember({"text", "json"}));
  command->callback([options, &session] { session.exit_code = measure(*options); });
}

}  // namespace periost
