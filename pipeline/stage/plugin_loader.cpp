#include "pipeline/stage/plugin_loader.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <set>

#include "pipeline/base/error.h"
#include "pipeline/stage/plugin.h"

namespace periost {
namespace {

[[noreturn]] void refuse(const char* code, const std::filesystem::path& file, const std::string& reason,
                         std::string hint = {}) {
  throw Error(ErrorKind::kUsage, code, fmt::format("plugin '{}' is refused: {}", file.string(), reason),
              std::move(hint));
}

// The reason alone: the library's text repeats the file's name.
std::string dl_reason(const std::filesystem::path& file) {
  const char* text = dlerror();
  std::string reason = text == nullptr ? "unknown reason" : text;
  const std::string prefix = file.string() + ": ";
  return reason.rfind(prefix, 0) == 0 ? reason.substr(prefix.size()) : reason;
}

PluginEntry open_entry(const std::filesystem::path& file) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) {
    refuse("plugin.unreadable", file, "there is no such file");
  }
  // Local, so that plugins cannot take each other's symbols; now, so that a missing one shows here and not in
  // a run.
  void* library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) {
    refuse("plugin.unreadable", file, fmt::format("it cannot be loaded ({})", dl_reason(file)));
  }
  void* symbol = dlsym(library, kPluginEntry);
  if (symbol == nullptr) {
    refuse("plugin.no_entry", file, fmt::format("it has no function '{}'", kPluginEntry),
           "build it with periost_add_stage()");
  }
  PluginEntry entry = nullptr;
  std::memcpy(&entry, &symbol, sizeof entry);  // POSIX allows it; a cast would not be portable C++
  return entry;
}

// Nothing but plain data may be read before this returns.
void check(const std::filesystem::path& file, const PluginInfo* info) {
  const std::string rebuild = "build it again with this Periost and this compiler";
  if (info == nullptr || info->magic != kPluginMagic) {
    refuse("plugin.wrong_magic", file, "its entry is not one of Periost's");
  }
  if (info->struct_size != sizeof(PluginInfo)) {
    refuse("plugin.wrong_size", file,
           fmt::format("its entry has {} bytes instead of {}", info->struct_size, sizeof(PluginInfo)),
           rebuild);
  }
  if (info->epoch != kPluginEpoch) {
    refuse("plugin.wrong_epoch", file,
           fmt::format("it was built for interface {}, this is interface {}", info->epoch, kPluginEpoch),
           rebuild);
  }
  const std::string fingerprint = info->fingerprint == nullptr ? "" : info->fingerprint;
  if (fingerprint != PERIOST_FINGERPRINT) {
    refuse("plugin.wrong_toolchain", file,
           fmt::format("it was built with '{}', this program with '{}'", fingerprint, PERIOST_FINGERPRINT),
           rebuild);
  }
  static constexpr std::uint32_t kSizes[kPluginSizes] = PERIOST_SIZES;
  if (!std::equal(std::begin(kSizes), std::end(kSizes), std::begin(info->sizes))) {
    refuse("plugin.wrong_toolchain", file, "its data types have other sizes than this program's", rebuild);
  }
}

void register_all(const std::filesystem::path& file, const PluginInfo& info, Registry& staging) {
  try {
    info.register_stages(staging);
  } catch (const Error& error) {
    throw Error(ErrorKind::kUsage, error.code(),
                fmt::format("plugin '{}' is refused: {}", file.string(), error.what()), error.hint());
  } catch (const std::exception& error) {
    refuse("plugin.register_failed", file,
           fmt::format("it failed while registering its stages ({})", error.what()));
  } catch (...) {
    refuse("plugin.register_failed", file, "it failed while registering its stages");
  }
  if (staging.names().empty()) refuse("plugin.no_stage", file, "it registers no stage");
}

std::string text_of(const char* text) {
  return text == nullptr ? std::string() : std::string(text);
}

// The files that PERIOST_PLUGIN_PATH names.
std::vector<std::filesystem::path> searched_files(const std::string& search_path) {
  std::vector<std::filesystem::path> files;
  for (std::size_t begin = 0; begin <= search_path.size();) {
    const std::size_t end = std::min(search_path.find(':', begin), search_path.size());
    const std::filesystem::path part = search_path.substr(begin, end - begin);
    begin = end + 1;
    std::error_code ignored;
    if (!std::filesystem::is_directory(part, ignored)) {
      if (!part.empty()) files.push_back(part);
      continue;
    }
    const std::size_t first = files.size();
    for (const auto& file : std::filesystem::directory_iterator(part, ignored)) {
      if (file.path().extension() == ".so") files.push_back(file.path());
    }
    std::sort(files.begin() + static_cast<std::ptrdiff_t>(first), files.end());
  }
  return files;
}

}  // namespace

LoadedPlugin load_plugin(const std::filesystem::path& file, Registry& registry) {
  // With a slash in it, dlopen() looks at this very file and not in the system's folders.
  const std::filesystem::path path = std::filesystem::absolute(file).lexically_normal();
  const PluginInfo* info = open_entry(path)();
  check(path, info);
  Registry staging;
  staging.set_origin(path.string());
  register_all(path, *info, staging);
  LoadedPlugin plugin{path, text_of(info->name), text_of(info->version), text_of(info->licence),
                      staging.names()};
  registry.merge(std::move(staging));
  return plugin;
}

std::vector<LoadedPlugin> load_plugins(const std::vector<std::filesystem::path>& files,
                                       const std::string& search_path, Registry& registry,
                                       Diagnostics& diagnostics) {
  std::vector<std::filesystem::path> all = files;
  const std::vector<std::filesystem::path> searched = searched_files(search_path);
  all.insert(all.end(), searched.begin(), searched.end());
  std::set<std::filesystem::path> seen;
  std::vector<LoadedPlugin> loaded;
  for (const std::filesystem::path& file : all) {
    if (!seen.insert(std::filesystem::weakly_canonical(file)).second) continue;
    try {
      loaded.push_back(load_plugin(file, registry));
    } catch (const Error& error) {
      diagnostics.push_back({Severity::kError, error.code(), {}, "plugins", {}, error.what(), error.hint()});
    }
  }
  return loaded;
}

}  // namespace periost
