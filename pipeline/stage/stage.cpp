#include "pipeline/stage/stage.h"

namespace periost {

void Preflight::error(std::string code, std::string key, std::string text, std::string hint) {
  diagnostics.push_back(
      {Severity::kError, std::move(code), {}, std::move(key), {}, std::move(text), std::move(hint)});
}

void Preflight::warning(std::string code, std::string key, std::string text, std::string hint) {
  diagnostics.push_back(
      {Severity::kWarning, std::move(code), {}, std::move(key), {}, std::move(text), std::move(hint)});
}

}  // namespace periost
