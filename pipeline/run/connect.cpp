#include "pipeline/run/connect.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

namespace periost {
namespace {

// Connects one stage.
class Connector {
 public:
  Connector(const StageEntry& entry, const StageDeclaration& declaration,
            const std::vector<PlanStep>& earlier, const std::vector<StageEntry>& chain,
            Diagnostics& diagnostics)
      : entry_(entry),
        declaration_(declaration),
        earlier_(earlier),
        chain_(chain),
        diagnostics_(diagnostics),
        chosen_(declaration.inputs.size()),
        is_failed_(declaration.inputs.size(), false) {}

  std::vector<PlanInput> run() {
    for (const InputChoice& choice : entry_.from)
      choice.port.empty() ? pick_by_kind(choice) : pick_by_port(choice);
    for (std::size_t i = 0; i < chosen_.size(); ++i) {
      if (!chosen_[i] && !is_failed_[i]) pick_newest(i);
    }
    std::vector<PlanInput> inputs;
    for (std::size_t i = 0; i < chosen_.size(); ++i) {
      if (!chosen_[i]) continue;
      check_properties(declaration_.inputs[i], *chosen_[i]);
      inputs.push_back(*chosen_[i]);
    }
    return inputs;
  }

 private:
  struct Source {
    const PlanStep* step;
    std::size_t index;
    std::string output;  // empty: any
  };

  void error(const char* code, const SourcePlace& place, std::string text, std::string hint = {}) {
    diagnostics_.push_back(
        {Severity::kError, code, entry_.id, "from", place, std::move(text), std::move(hint)});
  }

  // The step and output that `id` or `id.output` names, or nothing after an error.
  std::optional<Source> find_source(const InputChoice& choice) {
    const std::size_t dot = choice.source.find('.');
    const std::string id = choice.source.substr(0, dot);
    const std::string output = dot == std::string::npos ? "" : choice.source.substr(dot + 1);
    for (std::size_t i = 0; i < earlier_.size(); ++i) {
      if (earlier_[i].id == id) return Source{&earlier_[i], i, output};
    }
    std::vector<std::string> ids;
    for (const PlanStep& step : earlier_) ids.push_back(step.id);
    const bool is_later =
        std::any_of(chain_.begin(), chain_.end(), [&](const StageEntry& other) { return other.id == id; });
    if (is_later) {
      error("plan.later_id", choice.place, fmt::format("'{}' does not come before this stage", id));
    } else {
      const std::string near = nearest_name(id, ids);
      error("plan.unknown_id", choice.place, fmt::format("no stage before this one has the id '{}'", id),
            near.empty() ? "" : fmt::format("did you mean '{}'?", near));
    }
    return std::nullopt;
  }

  // The output of a source that an input can take.
  std::optional<PlanInput> match(const Source& source, const Port& port) const {
    const std::vector<Port>& outputs = source.step->declaration->outputs;
    for (std::size_t output = 0; output < outputs.size(); ++output) {
      const bool is_named = source.output.empty() || outputs[output].name == source.output;
      if (port.kind == ArtefactKind::kHints) continue;
      if (is_named && outputs[output].kind == port.kind)
        return PlanInput{port.name, source.index, output, port.kind};
    }
    return std::nullopt;
  }

  // The same for an input that the file names: there an isosurface may stand for a surface, and a surface for
  // an isosurface.
  std::optional<PlanInput> match_named(const Source& source, const Port& port) const {
    if (auto found = match(source, port)) return found;
    if (port.kind == ArtefactKind::kSurface) return match_standing(source, port, ArtefactKind::kIsosurface);
    if (port.kind == ArtefactKind::kIsosurface) return match_standing(source, port, ArtefactKind::kSurface);
    return std::nullopt;
  }

  // An output of another kind, which then stands for the port's.
  std::optional<PlanInput> match_standing(const Source& source, Port port, ArtefactKind other) const {
    const ArtefactKind wanted = std::exchange(port.kind, other);
    std::optional<PlanInput> found = match(source, port);
    if (found) found->kind = wanted;
    return found;
  }

  // Where no stage made an isosurface: the surface that stood for it before, or, where one is needed, the
  // newest.
  std::optional<PlanInput> surface_for_isosurface(const Port& port) const {
    for (std::size_t step = earlier_.size(); step-- > 0;) {
      for (const PlanInput& input : earlier_[step].inputs) {
        if (input.kind == ArtefactKind::kIsosurface)
          return PlanInput{port.name, input.step, input.output, port.kind};
      }
    }
    for (std::size_t step = earlier_.size(); !port.optional && step-- > 0;) {
      if (auto found = match_standing({&earlier_[step], step, {}}, port, ArtefactKind::kSurface))
        return found;
    }
    return std::nullopt;
  }

  void pick_by_kind(const InputChoice& choice) {
    const std::optional<Source> source = find_source(choice);
    // Of a stage that is unknown itself nothing can be said.
    if (!source || source->step->declaration == nullptr) return is_failed_.assign(is_failed_.size(), true);
    bool is_used = false;
    for (std::size_t i = 0; i < chosen_.size(); ++i) {
      if (declaration_.inputs[i].by_name) continue;
      const std::optional<PlanInput> input = match(*source, declaration_.inputs[i]);
      if (!input || chosen_[i]) continue;
      // A source with one such output feeds one input of a kind; further ones are for the next entry of
      // `from`.
      const bool is_taken = std::any_of(
          chosen_.begin(), chosen_.begin() + static_cast<std::ptrdiff_t>(i), [&](const auto& other) {
            return other && other->step == input->step && other->output == input->output;
          });
      if (is_taken) continue;
      chosen_[i] = input;
      is_used = true;
    }
    if (!is_used) no_match(choice);
  }

  void pick_by_port(const InputChoice& choice) {
    const std::vector<Port>& inputs = declaration_.inputs;
    const auto found = std::find_if(inputs.begin(), inputs.end(),
                                    [&](const Port& port) { return port.name == choice.port; });
    if (found == inputs.end()) {
      std::vector<std::string> names;
      for (const Port& port : inputs) names.push_back(port.name);
      return error(
          "plan.unknown_port", choice.place, fmt::format("it has no input '{}'", choice.port),
          names.empty() ? "it takes none" : fmt::format("its inputs are {}", fmt::join(names, ", ")));
    }
    const auto i = static_cast<std::size_t>(found - inputs.begin());
    const std::optional<Source> source = find_source(choice);
    const bool is_known = source && source->step->declaration != nullptr;
    if (is_known) chosen_[i] = match_named(*source, *found);
    if (is_known && !chosen_[i]) no_match(choice);
    is_failed_[i] = !chosen_[i];
  }

  void no_match(const InputChoice& choice) {
    std::vector<std::string_view> wanted;
    for (const Port& port : declaration_.inputs) {
      if (choice.port.empty() || port.name == choice.port) wanted.push_back(name_of(port.kind));
    }
    error("plan.kind_mismatch", choice.place,
          fmt::format("'{}' gives nothing that this stage takes", choice.source),
          wanted.empty() ? "it takes no input" : fmt::format("it takes {}", fmt::join(wanted, ", ")));
  }

  void pick_newest(std::size_t i) {
    const Port& port = declaration_.inputs[i];
    if (port.by_name || port.kind == ArtefactKind::kHints) return;
    const auto has_kind = [&](const Port& other) { return other.kind == port.kind && !other.by_name; };
    const bool is_first = std::none_of(
        declaration_.inputs.begin(), declaration_.inputs.begin() + static_cast<std::ptrdiff_t>(i), has_kind);
    for (std::size_t step = earlier_.size(); is_first && step-- > 0;) {
      if (earlier_[step].declaration == nullptr) {  // an unknown stage: it might have brought it
        maybe_produced_ = true;
        continue;
      }
      chosen_[i] = match(Source{&earlier_[step], step, {}}, port);
      if (chosen_[i]) return;
    }
    if (is_first && port.kind == ArtefactKind::kIsosurface && !maybe_produced_) {
      chosen_[i] = surface_for_isosurface(port);
      if (chosen_[i]) return;
    }
    if (port.optional || maybe_produced_) return;
    if (!is_first) {
      error("plan.ambiguous_input", entry_.place, fmt::format("its input '{}' must be chosen", port.name),
            fmt::format("write from: {{{}: ID}}", port.name));
    } else {
      error("plan.missing_input", entry_.place,
            fmt::format("it needs {} {}, and no stage before it makes one", article(port.kind),
                        name_of(port.kind)));
    }
  }

  static const char* article(ArtefactKind kind) {
    return kind == ArtefactKind::kImage || kind == ArtefactKind::kIsosurface ? "an" : "a";
  }

  void check_properties(const Port& required, const PlanInput& input) {
    const PlanStep& producer = earlier_[input.step];
    const SurfaceProperties& given = producer.declaration->outputs[input.output].properties;
    std::vector<std::string> missing;
    if (required.properties.closed && !given.closed) missing.emplace_back("closed");
    if (required.properties.manifold && !given.manifold) missing.emplace_back("manifold");
    if (required.properties.oriented && !given.oriented) missing.emplace_back("oriented");
    if (missing.empty()) return;
    error("plan.property", entry_.place,
          fmt::format("its input '{}' must be {}, which '{}' does not guarantee", required.name,
                      fmt::join(missing, " and "), producer.id));
  }

  const StageEntry& entry_;
  const StageDeclaration& declaration_;
  const std::vector<PlanStep>& earlier_;
  const std::vector<StageEntry>& chain_;
  Diagnostics& diagnostics_;
  std::vector<std::optional<PlanInput>> chosen_;  // by input
  std::vector<bool> is_failed_;                   // already complained about
  bool maybe_produced_ = false;
};

}  // namespace

std::vector<PlanInput> connect(const StageEntry& entry, const StageDeclaration& declaration,
                               const std::vector<PlanStep>& earlier, const std::vector<StageEntry>& chain,
                               Diagnostics& diagnostics) {
  return Connector(entry, declaration, earlier, chain, diagnostics).run();
}

}  // namespace periost
