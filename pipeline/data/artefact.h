#pragma once
// What travels between stages: an immutable, shared value of one of nine kinds.
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "pipeline/data/deck.h"
#include "pipeline/data/hints.h"
#include "pipeline/data/image.h"
#include "pipeline/data/isosurface.h"
#include "pipeline/data/mask.h"
#include "pipeline/data/quality_report.h"
#include "pipeline/data/simplex_mesh.h"
#include "pipeline/data/surface_mesh.h"
#include "pipeline/data/tet_mesh.h"

namespace periost {

enum class ArtefactKind {
  kImage,
  kMask,
  kIsosurface,
  kSimplexMesh,
  kSurface,
  kTetMesh,
  kQuality,
  kDeck,
  kHints
};
inline constexpr int kArtefactKinds = 9;

// Alternatives stand in the order of ArtefactKind.
using Artefact =
    std::variant<std::shared_ptr<const Image>, std::shared_ptr<const Mask>, std::shared_ptr<const Isosurface>,
                 std::shared_ptr<const SimplexMesh>, std::shared_ptr<const SurfaceMesh>,
                 std::shared_ptr<const TetMesh>, std::shared_ptr<const QualityReport>,
                 std::shared_ptr<const Deck>, std::shared_ptr<const Hints>>;

inline ArtefactKind kind_of(const Artefact& artefact) {
  return static_cast<ArtefactKind>(artefact.index());
}

// An isosurface's triangles as a surface, which shares its memory; any other artefact as it is.
Artefact as_surface(const Artefact& artefact);

// The kind of a data type: kind_of_type<Image>() == ArtefactKind::kImage.
template <class T>
ArtefactKind kind_of_type() {
  return static_cast<ArtefactKind>(Artefact(std::shared_ptr<const T>()).index());
}

// "image", "mask", "isosurface", "simplex_mesh", "surface", "tet_mesh", "quality", "deck",
// "hints".
std::string_view name_of(ArtefactKind kind);
std::optional<ArtefactKind> kind_from_name(std::string_view name);

// A few numbers that describe an artefact in run.json and on the terminal: dims, triangles, tets.
std::map<std::string, double> facts_of(const Artefact& artefact);
// Bytes of memory that it occupies, roughly.
std::size_t memory_bytes(const Artefact& artefact);

}  // namespace periost
