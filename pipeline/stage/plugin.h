#pragma once
// How a shared library built elsewhere brings stages. An author writes a stage as in stage.h and builds it
// with periost_add_stage() from the installed CMake package, which generates the entry below;
// examples/plugin_stage is a complete project. The entry is plain data, read and compared before any C++
// object crosses.
#include <cstdint>
#include <string>
#include <vector>

#include "pipeline/stage/stage.h"

namespace periost {

// Raised when a stage built before cannot work with the framework any more.
inline constexpr std::uint32_t kPluginEpoch = 2;
inline constexpr std::uint64_t kPluginMagic = 0x54534F4952455031;  // "1PERIOST" in memory

// What must be equal on both sides of the boundary beside the epoch: the compiler and its version, the ABI of
// the standard library, the language, and Periost itself.
#if defined(__clang__)
#define PERIOST_COMPILER "clang " __clang_version__
#elif defined(__GNUC__)
#define PERIOST_COMPILER "gcc " __VERSION__
#else
#define PERIOST_COMPILER "unknown compiler"
#endif
#define PERIOST_TEXT_OF(X) #X
#define PERIOST_EXPANDED_TEXT(X) PERIOST_TEXT_OF(X)
#ifdef _GLIBCXX_USE_CXX11_ABI
#define PERIOST_STANDARD_LIBRARY "libstdc++ abi " PERIOST_EXPANDED_TEXT(_GLIBCXX_USE_CXX11_ABI)
#else
#define PERIOST_STANDARD_LIBRARY "other standard library"
#endif
#define PERIOST_FINGERPRINT                      \
  PERIOST_COMPILER "; " PERIOST_STANDARD_LIBRARY \
                   "; C++ " PERIOST_EXPANDED_TEXT(__cplusplus) "; Periost " PERIOST_VERSION

// Sizes of types that cross; they catch what the fingerprint cannot, such as a macro that changes a layout.
inline constexpr std::uint32_t kPluginSizes = 8;
#define PERIOST_SIZES                                                                                    \
  {                                                                                                      \
    sizeof(void*), sizeof(std::string), sizeof(std::vector<int>), sizeof(::periost::Value),              \
        sizeof(::periost::ParamInfo), sizeof(::periost::StageDeclaration), sizeof(::periost::Preflight), \
        sizeof(::periost::Context)                                                                       \
  }

// The plain data. The first three members never move.
struct PluginInfo {
  std::uint64_t magic;
  std::uint32_t struct_size;
  std::uint32_t epoch;
  std::uint32_t sizes[kPluginSizes];
  const char* fingerprint;
  const char* name;
  const char* version;
  const char* licence;
  void (*register_stages)(Registry& registry);
};

inline constexpr const char* kPluginEntry = "periost_plugin";
using PluginEntry = const PluginInfo* (*)();

}  // namespace periost

// Defines the entry of a library whose stage was given by PERIOST_STAGE(NAME, ...). periost_add_stage()
// writes it.
#define PERIOST_PLUGIN(NAME, VERSION, LICENCE)                                                      \
  void periost_register_##NAME(::periost::Registry& registry);                                      \
  extern "C" __attribute__((visibility("default"))) const ::periost::PluginInfo* periost_plugin() { \
    static const ::periost::PluginInfo info{::periost::kPluginMagic,                                \
                                            sizeof(::periost::PluginInfo),                          \
                                            ::periost::kPluginEpoch,                                \
                                            PERIOST_SIZES,                                          \
                                            PERIOST_FINGERPRINT,                                    \
                                            #NAME,                                                  \
                                            VERSION,                                                \
                                            LICENCE,                                                \
                                            &periost_register_##NAME};                              \
    return &info;                                                                                   \
  }
