#pragma once
// quality.json: a report as JSON, schema periost-quality/1 (docs/quality.md), and hints.json likewise.
#include <filesystem>
#include <string>

#include "pipeline/data/hints.h"
#include "pipeline/data/quality_report.h"

namespace periost {

// The text, indented, ending in a line feed. What was not measured is absent, never 0. Numbers are the
// shortest decimals that read back to the same double; the same report gives the same bytes.
std::string quality_json(const QualityReport& report);

// The file appears whole or not at all. Throws Error{kLimit, "file.disk_full" | "file.unwritable"}.
void write_quality_json(const QualityReport& report, const std::filesystem::path& path);

// hints.json, schema periost-hints/1 (docs/feedback.md), by the same rules.
std::string hints_json(const Hints& hints);
void write_hints_json(const Hints& hints, const std::filesystem::path& path);

// "pass", "warn", "fail".
std::string name_of(Verdict verdict);

}  // namespace periost
