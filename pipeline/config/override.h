#pragma once
// `--set KEY=VALUE` on a document: KEY is the path of a key, by a stage's id or its kind where that is unique
// (`decimate.distance`, `verify.gates."volume.min_dihedral_deg.min".limit`, `read_image.raw.dims[2]`) or from
// the top
// (`feedback.max_rounds`); VALUE is YAML on one line.
#include <string>
#include <vector>

#include "pipeline/base/diagnostic.h"
#include "pipeline/param/value.h"

namespace periost {

// Applies one override. Keys with dots in them are found without quotes when the document has them already.
// Errors: config.bad_override (no '=', an index that is not there), config.unknown_id, config.ambiguous_id.
void apply_override(Value& document, const std::string& text, Diagnostics& diagnostics);

// The ids of the entries of `chain:`, given or by default (kind, kind_2, ...), in their order; "" where an
// entry has neither id nor kind. Given ids are never taken by a default.
std::vector<std::string> stage_ids(const Value& chain);

}  // namespace periost
