#pragma once
// A plan before, and a run after, as short tables for the terminal.
#include <filesystem>
#include <string>

#include "pipeline/run/manifest.h"
#include "pipeline/run/plan.h"

namespace periost {

// What --dry-run prints: stages, what they are expected to make, memory.
std::string plan_table(const Plan& plan);

// "up to 4 rounds; from the second on: decimate, verify" as a line; nothing without feedback.
std::string rounds_text(const Plan& plan);

// What a run prints at its end: time and facts of each stage, verdict, and the files in `folder`.
std::string run_table(const Manifest& manifest, const std::filesystem::path& folder);

}  // namespace periost
