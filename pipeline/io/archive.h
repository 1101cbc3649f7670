#pragma once
// Artefacts as binary files, bit for bit, for the cache of a run. Not an exchange format: its version changes
// with the data types, and a file of another version counts as absent.
//
// Layout (little-endian): "PERIOART", u32 version, u32 kind, u64 bytes of payload, payload, xxh128 of kind
// and payload as 32 hexadecimal digits. Every length in the payload is checked against the bytes that are
// left before memory is taken, so a damaged or forged file costs no more than its own size.
//
// An isosurface's block table comes back with the same entries; the order in which an unordered_map lists
// them is not part of the value, so no result may depend on it.
#include <filesystem>
#include <optional>
#include <string>

#include "pipeline/data/artefact.h"

namespace periost {

// The hash of an artefact's value: equal values have equal hashes on every machine of the same byte order.
// O(size).
std::string hash_artefact(const Artefact& artefact);

// Writes `path` whole or not at all and returns hash_artefact(artefact). Throws Error{kLimit} of AtomicFile.
std::string save_artefact(const Artefact& artefact, const std::filesystem::path& path);

// The artefact, or nothing when the file is missing, damaged, of another version, of another kind or of
// another hash.
std::optional<Artefact> load_artefact(const std::filesystem::path& path, ArtefactKind kind,
                                      const std::string& hash);

}  // namespace periost
