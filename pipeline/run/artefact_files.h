#pragma once
// Which kinds of artefacts a run leaves as files, under which names, and by which writer.
#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/data/artefact.h"

namespace periost {

// "surface.vtp"; empty for kinds that never become a file of their own (decks are files already).
std::string file_name_of(ArtefactKind kind);
// Left by every run whose chain makes one; the others are left when --save names them.
bool is_always_saved(ArtefactKind kind);
// Names that --save takes.
std::vector<std::string> saveable_kinds();

// Writes `folder`/file_name_of(kind), whole or not at all, the same bits for the same artefact.
// Precondition: file_name_of is not empty. Throws Error{kLimit}.
void write_artefact_file(const Artefact& artefact, const std::filesystem::path& folder);

}  // namespace periost
