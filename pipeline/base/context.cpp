#include "pipeline/base/context.h"

#include <algorithm>

#include "pipeline/base/error.h"

namespace periost {

void Context::emit(Event::Level level, std::string_view code, std::string_view text) const {
  if (sink) sink(Event{level, stage, std::string(code), std::string(text)});
}

void Context::debug(std::string_view code, std::string_view text) const {
  emit(Event::Level::kDebug, code, text);
}
void Context::info(std::string_view code, std::string_view text) const {
  emit(Event::Level::kInfo, code, text);
}
void Context::warn(std::string_view code, std::string_view text) const {
  emit(Event::Level::kWarning, code, text);
}

bool Context::is_cancelled() const {
  return cancelled != nullptr && cancelled->load(std::memory_order_relaxed);
}

void Context::check_cancelled() const {
  if (is_cancelled()) throw Error(ErrorKind::kInterrupted, "run.interrupted", "interrupted");
}

Progress::Progress(const Context& context, std::string_view what, std::uint64_t total)
    : context_(context), what_(what), total_(total), stride_(std::max<std::uint64_t>(total / 100, 1)) {
  if (context_.sink) context_.sink(Event{Event::Level::kProgress, context_.stage, {}, what_, 0, total_});
}

Progress::~Progress() {
  const std::uint64_t done = done_.load(std::memory_order_relaxed);
  if (context_.sink) context_.sink(Event{Event::Level::kProgress, context_.stage, {}, what_, done, done});
}

void Progress::step(std::uint64_t count) {
  context_.check_cancelled();
  const std::uint64_t before = done_.fetch_add(count, std::memory_order_relaxed);
  if (!context_.sink || before / stride_ == (before + count) / stride_) return;
  context_.sink(Event{Event::Level::kProgress, context_.stage, {}, what_, before + count, total_});
}

}  // namespace periost
