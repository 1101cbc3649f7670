#pragma once
// What the author of a stage writes: an Options struct, a declaration, `preflight` and `run`. A stage has no
// state; everything it needs comes in as options, inputs and context.
//
//   class DecimateStage final : public StageOf<DecimateOptions> {
//    public:
//     void declare(Declaration<DecimateOptions>& d) const override {
//       d.stage("decimate", 1, "Decimates an isosurface as a deformable simplex mesh.")
//           .input<Isosurface>("isosurface", "The surface to decimate.", {.manifold = true})
//           .output<SimplexMesh>("simplex_mesh", "The decimated model.")
//           .param("distance", &DecimateOptions::distance, Quantity::kLength, Range::above(0),
//                  "Largest distance between the decimated surface and the isosurface.");
//     }
//     Outputs run(const DecimateOptions& options, const Inputs& inputs, Context& context) const override {
//       return {decimate(inputs.get<Isosurface>("isosurface"), options, context)};
//     }
//   };
//   PERIOST_STAGE(decimate, DecimateStage)   // at file scope, outside any namespace
//
// Kinds of parameters and the hooks that enumerations, groups and text types need: param/codec.h.
#include <any>
#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "pipeline/base/context.h"
#include "pipeline/base/diagnostic.h"
#include "pipeline/param/param_table.h"
#include "pipeline/stage/port.h"

namespace periost {

// The artefacts that the plan chose for a stage's inputs, by port name.
class Inputs {
 public:
  void set(const std::string& port, Artefact artefact) {
    artefacts_.insert_or_assign(port, std::move(artefact));
  }
  bool has(const std::string& port) const { return artefacts_.contains(port); }

  // Precondition: the port is declared with this type and is connected.
  template <class T>
  const T& get(const std::string& port) const {
    return *std::get<std::shared_ptr<const T>>(artefacts_.at(port));
  }
  // The artefact, or null when an optional input is not connected.
  template <class T>
  std::shared_ptr<const T> find(const std::string& port) const {
    const auto found = artefacts_.find(port);
    return found == artefacts_.end() ? nullptr : std::get<std::shared_ptr<const T>>(found->second);
  }

 private:
  std::map<std::string, Artefact> artefacts_;
};

// The results of a run, one for each declared output, in the order of declaration.
class Outputs {
 public:
  Outputs() = default;
  template <class... Ts>
  Outputs(Ts&&... values) {  // NOLINT(google-explicit-constructor): lets run() write `return {mesh};`
    (add(std::forward<Ts>(values)), ...);
  }

  // Takes a value, or a shared pointer to const for one that is passed on unchanged.
  template <class T>
  void add(T value) {
    artefacts_.emplace_back(std::make_shared<const T>(std::move(value)));
  }
  template <class T>
  void add(std::shared_ptr<const T> value) {
    artefacts_.emplace_back(std::move(value));
  }
  const std::vector<Artefact>& artefacts() const { return artefacts_; }

 private:
  std::vector<Artefact> artefacts_;
};

// What is known of an artefact before it exists: upper estimates, 0 for unknown.
struct Forecast {
  std::array<std::int32_t, 3> dims{0, 0, 0};
  std::uint64_t triangles = 0;
  std::uint64_t tets = 0;
  double voxel_mm = 0;  // 0: unknown, or no image behind it
};

// The dry run of one stage: it sees its options and the forecasts of its inputs, adds diagnostics (with the
// key concerned) and returns the forecasts of its outputs.
struct Preflight {
  std::map<std::string, Forecast> inputs;    // by port
  std::map<std::string, Forecast> outputs;   // by port; filled in
  std::uint64_t peak_bytes = 0;              // estimate of the stage's own peak memory; filled in
  std::vector<std::filesystem::path> reads;  // input files, filled in; their content enters the cache key
  Diagnostics diagnostics;                   // filled in; stage and place are completed by the plan

  // Adds an error about a key of this stage.
  void error(std::string code, std::string key, std::string text, std::string hint = {});
  void warning(std::string code, std::string key, std::string text, std::string hint = {});
};

// Everything about a kind of stage that is data.
struct StageDeclaration {
  std::string name;  // its value in `stage:`
  std::uint32_t version =
      1;                // raised when the same inputs and options give other results; part of the cache key
  std::string summary;  // one sentence
  std::vector<Port> inputs;
  std::vector<Port> outputs;
  std::shared_ptr<const ParamTableBase> params;
};

// The interface that the framework sees. Authors derive from StageOf.
class Stage {
 public:
  virtual ~Stage() = default;
  virtual StageDeclaration declaration() const = 0;
  // `options` holds the Options struct that declaration().params decoded.
  virtual void preflight_any(const std::any& options, Preflight& preflight) const = 0;
  virtual Outputs run_any(const std::any& options, const Inputs& inputs, Context& context) const = 0;
};

// Collects a declaration; every part is mandatory, so that help, schema and documentation are never empty.
template <class Options>
class Declaration {
 public:
  Declaration& stage(std::string name, std::uint32_t version, std::string summary) {
    declaration_.name = std::move(name);
    declaration_.version = version;
    declaration_.summary = std::move(summary);
    return *this;
  }
  template <class T>
  Declaration& input(std::string name, std::string doc, SurfaceProperties required = {}) {
    declaration_.inputs.push_back({std::move(name), kind_of_type<T>(), required, false, std::move(doc)});
    return *this;
  }
  template <class T>
  Declaration& optional_input(std::string name, std::string doc, SurfaceProperties required = {}) {
    declaration_.inputs.push_back({std::move(name), kind_of_type<T>(), required, true, std::move(doc)});
    return *this;
  }
  // An optional input that the newest artefact of its kind would be wrong for: only `from: {NAME: ID}`
  // connects it.
  template <class T>
  Declaration& named_input(std::string name, std::string doc, SurfaceProperties required = {}) {
    declaration_.inputs.push_back({std::move(name), kind_of_type<T>(), required, true, std::move(doc), true});
    return *this;
  }
  template <class T>
  Declaration& output(std::string name, std::string doc, SurfaceProperties guaranteed = {}) {
    declaration_.outputs.push_back({std::move(name), kind_of_type<T>(), guaranteed, false, std::move(doc)});
    return *this;
  }
  // See ParamTable::param. The default is what Options{} holds.
  template <class Member>
  Declaration& param(std::string name, Member Options::*member, Quantity quantity, Range range,
                     std::string doc) {
    params_.param(std::move(name), member, quantity, range, std::move(doc));
    return *this;
  }
  StageDeclaration take() {
    declaration_.params = std::make_shared<const ParamTable<Options>>(std::move(params_));
    return std::move(declaration_);
  }

 private:
  StageDeclaration declaration_;
  ParamTable<Options> params_;
};

// Base of every stage: keeps the types, so that authors never see std::any.
template <class Options>
class StageOf : public Stage {
 public:
  virtual void declare(Declaration<Options>& declaration) const = 0;
  virtual void preflight(const Options& /*options*/, Preflight& /*preflight*/) const {}
  virtual Outputs run(const Options& options, const Inputs& inputs, Context& context) const = 0;

  StageDeclaration declaration() const final {
    Declaration<Options> declaration;
    declare(declaration);
    return declaration.take();
  }
  void preflight_any(const std::any& options, Preflight& preflight) const final {
    this->preflight(std::any_cast<const Options&>(options), preflight);
  }
  Outputs run_any(const std::any& options, const Inputs& inputs, Context& context) const final {
    return run(std::any_cast<const Options&>(options), inputs, context);
  }
};

class Registry;
// Hands a stage to the registry (registry.h); throws as Registry::add.
void register_stage(Registry& registry, std::unique_ptr<Stage> stage);

}  // namespace periost

// Defines periost_register_NAME, which the generated stage list (in tree) or the plugin entry (out of tree)
// calls.
#define PERIOST_STAGE(NAME, CLASS)                                  \
  void periost_register_##NAME(::periost::Registry& registry);      \
  void periost_register_##NAME(::periost::Registry& registry) {     \
    ::periost::register_stage(registry, std::make_unique<CLASS>()); \
  }
