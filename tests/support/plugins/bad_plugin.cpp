// One source, many faulty plugins: FAULT chooses which.
#include <stdexcept>

#include "pipeline/stage/plugin.h"

namespace {

struct NoOptions {};

class FaultyStage final : public periost::StageOf<NoOptions> {
 public:
  explicit FaultyStage(std::string name) : name_(std::move(name)) {}
  void declare(periost::Declaration<NoOptions>& d) const override { d.stage(name_, 1, "Does nothing."); }
  periost::Outputs run(const NoOptions&, const periost::Inputs&, periost::Context&) const override {
    return {};
  }

 private:
  std::string name_;
};

void register_faulty([[maybe_unused]] periost::Registry& registry) {
#ifndef FAULT_EMPTY
  periost::register_stage(registry, std::make_unique<FaultyStage>("first_of_" STAGE_NAME));
#endif
#ifdef FAULT_THROWS
  throw std::runtime_error("out of luck");
#endif
#ifdef FAULT_THROWS_ANYTHING
  throw 42;
#endif
#ifdef FAULT_DUPLICATE
  periost::register_stage(registry, std::make_unique<FaultyStage>("taken"));
#endif
#ifdef FAULT_TWICE
  periost::register_stage(registry, std::make_unique<FaultyStage>("first_of_" STAGE_NAME));
#endif
#ifdef FAULT_BAD_NAME
  periost::register_stage(registry, std::make_unique<FaultyStage>("Bad Name"));
#endif
}

[[maybe_unused]] periost::PluginInfo make_info() {
  periost::PluginInfo info{periost::kPluginMagic,
                           sizeof(periost::PluginInfo),
                           periost::kPluginEpoch,
                           PERIOST_SIZES,
                           PERIOST_FINGERPRINT,
                           "faulty",
                           "1",
                           "BSD-3-Clause",
                           &register_faulty};
#ifdef FAULT_MAGIC
  info.magic = 7;
#endif
#ifdef FAULT_SIZE
  info.struct_size = 8;
#endif
#ifdef FAULT_EPOCH
  info.epoch = periost::kPluginEpoch + 1;
#endif
#ifdef FAULT_FINGERPRINT
  info.fingerprint = "gcc 4.9";
#endif
#ifdef FAULT_NO_FINGERPRINT
  info.fingerprint = nullptr;
#endif
#ifdef FAULT_SIZES
  info.sizes[2] += 8;
#endif
  return info;
}

}  // namespace

#ifdef FAULT_UNRESOLVED
extern "C" int periost_nobody_defines_this();
extern "C" int periost_call_it() {
  return periost_nobody_defines_this();
}
#endif

#ifndef FAULT_NO_ENTRY
extern "C" const periost::PluginInfo* periost_plugin() {
#ifdef FAULT_NULL
  return nullptr;
#else
  static const periost::PluginInfo info = make_info();
  return &info;
#endif
}
#else
extern "C" const periost::PluginInfo* another_name() {
  static const periost::PluginInfo info = make_info();
  return &info;
}
#endif
