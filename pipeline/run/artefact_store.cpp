#include "pipeline/run/artefact_store.h"

#include <algorithm>

namespace periost {
namespace {

std::size_t number_of(ArtefactKind kind) {
  return static_cast<std::size_t>(kind);
}

}  // namespace

ArtefactStore::ArtefactStore(const Plan& plan, const std::set<ArtefactKind>& as_files)
    : plan_(plan), as_files_(as_files) {
  for (std::size_t step = 0; step < plan.steps.size(); ++step) {
    const std::size_t outputs = plan.steps[step].declaration->outputs.size();
    slots_.emplace_back(outputs);
    last_use_.emplace_back(outputs, step);
    for (const PlanInput& input : plan.steps[step].inputs) {
      const bool is_kept = !plan.steps[input.step].repeats && plan.steps[step].repeats;
      std::size_t& last = last_use_[input.step][input.output];
      last = std::max(last, is_kept ? plan.steps.size() : step);
    }
  }
}

void ArtefactStore::put(Place place, Artefact artefact) {
  const ArtefactKind kind = kind_of(artefact);
  slots_[place.step][place.output] = std::move(artefact);
  if (as_files_.contains(kind)) newest_unwritten_[number_of(kind)] = place;
}

std::size_t ArtefactStore::last_maker(ArtefactKind kind) const {
  for (std::size_t step = plan_.steps.size(); step-- > 0;) {
    const std::vector<Port>& outputs = plan_.steps[step].declaration->outputs;
    if (std::any_of(outputs.begin(), outputs.end(), [kind](const Port& port) { return port.kind == kind; })) {
      return step;
    }
  }
  return 0;
}

std::vector<ArtefactStore::Place> ArtefactStore::due_after(std::size_t step) const {
  std::vector<Place> due;
  for (const auto& place : newest_unwritten_) {
    if (place && last_maker(kind_of(at(*place))) <= step) due.push_back(*place);
  }
  return due;
}

std::vector<ArtefactStore::Place> ArtefactStore::unwritten() const {
  std::vector<Place> places;
  for (const auto& place : newest_unwritten_) {
    if (place) places.push_back(*place);
  }
  return places;
}

void ArtefactStore::mark_written(Place place) {
  newest_unwritten_[number_of(kind_of(at(place)))].reset();
}

bool ArtefactStore::is_newest(Place place) const {
  return std::any_of(newest_unwritten_.begin(), newest_unwritten_.end(), [&](const auto& newest) {
    return newest && newest->step == place.step && newest->output == place.output;
  });
}

void ArtefactStore::release_after(std::size_t step) {
  for (std::size_t s = 0; s <= step; ++s) {
    for (std::size_t output = 0; output < slots_[s].size(); ++output) {
      if (last_use_[s][output] <= step && !is_newest({s, output})) slots_[s][output].reset();
    }
  }
}

void ArtefactStore::begin_round() {
  newest_unwritten_.fill(std::nullopt);
  for (std::size_t step = 0; step < slots_.size(); ++step) {
    if (!plan_.steps[step].repeats) continue;
    for (auto& slot : slots_[step]) slot.reset();
  }
}

}  // namespace periost
