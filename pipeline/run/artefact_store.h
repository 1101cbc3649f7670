#pragma once
// Holds the artefacts of a run for as long as somebody needs them: a later stage, or the file that a kind is
// left as.
#include <array>
#include <optional>
#include <set>
#include <vector>

#include "pipeline/run/plan.h"

namespace periost {

class ArtefactStore {
 public:
  // `as_files`: kinds whose newest artefact becomes a file. The plan must outlive the store.
  ArtefactStore(const Plan& plan, const std::set<ArtefactKind>& as_files);

  // One output of one step.
  struct Place {
    std::size_t step = 0;
    std::size_t output = 0;
  };

  void put(Place place, Artefact artefact);
  // Precondition: put, and not yet released.
  const Artefact& at(Place place) const { return *slots_[place.step][place.output]; }

  // Artefacts that shall become files now: of kinds that no later step than `step` makes.
  std::vector<Place> due_after(std::size_t step) const;
  // Artefacts that are still to become files, when the run ends early.
  std::vector<Place> unwritten() const;
  void mark_written(Place place);
  // Frees what no step behind `step` needs. With feedback, what steps that run once give to steps that run
  // again stays to the end.
  void release_after(std::size_t step);
  // Forgets what the steps that run again made, and what was to become a file.
  void begin_round();

 private:
  std::size_t last_maker(ArtefactKind kind) const;
  bool is_newest(Place place) const;

  const Plan& plan_;
  std::set<ArtefactKind> as_files_;
  std::vector<std::vector<std::optional<Artefact>>> slots_;  // by step and output
  std::vector<std::vector<std::size_t>> last_use_;           // last step that reads it; its own if none
  std::array<std::optional<Place>, kArtefactKinds> newest_unwritten_;  // by kind
};

}  // namespace periost
