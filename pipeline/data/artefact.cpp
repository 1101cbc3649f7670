#include "pipeline/data/artefact.h"

#include <array>

namespace periost {
namespace {

constexpr std::array<std::string_view, kArtefactKinds> kNames{
    "image", "mask", "isosurface", "simplex_mesh", "surface", "tet_mesh", "quality", "deck", "hints"};

using Facts = std::map<std::string, double>;

template <class T>
std::size_t bytes_of(const std::vector<T>& values) {
  return values.size() * sizeof(T);
}

std::size_t bytes_of(const Fields& fields) {
  std::size_t bytes = 0;
  for (const auto& [name, values] : fields) bytes += bytes_of(values);
  return bytes;
}

std::size_t bytes_of(const SurfaceMesh& mesh) {
  return bytes_of(mesh.points) + bytes_of(mesh.triangles) + bytes_of(mesh.point_fields) +
         bytes_of(mesh.triangle_fields);
}

void add_dims(Facts& facts, const GridFrame& frame) {
  facts["size_i"] = frame.dims[0];
  facts["size_j"] = frame.dims[1];
  facts["size_k"] = frame.dims[2];
}

struct FactsOf {
  Facts operator()(const Image& image) const {
    Facts facts;
    add_dims(facts, image.frame);
    return facts;
  }
  Facts operator()(const Mask& mask) const {
    Facts facts;
    add_dims(facts, mask.frame);
    std::size_t inside = 0;
    for (const std::uint8_t value : mask.inside) inside += value;
    facts["inside_voxels"] = static_cast<double>(inside);
    return facts;
  }
  Facts operator()(const SurfaceMesh& mesh) const {
    return {{"triangles", static_cast<double>(mesh.triangles.size())},
            {"vertices", static_cast<double>(mesh.points.size())}};
  }
  Facts operator()(const Isosurface& isosurface) const { return (*this)(isosurface.surface); }
  Facts operator()(const SimplexMesh& mesh) const {
    return {{"vertices", static_cast<double>(mesh.position.size())},
            {"faces", static_cast<double>(mesh.dual_position.size())},
            {"rate", mesh.report.rate()}};
  }
  Facts operator()(const TetMesh& mesh) const {
    return {{"tets", static_cast<double>(mesh.tets.size())},
            {"points", static_cast<double>(mesh.points.size())},
            {"order", static_cast<double>(mesh.order())}};
  }
  Facts operator()(const QualityReport& report) const {
    return {{"gates", static_cast<double>(report.gates.size())}};
  }
  Facts operator()(const Deck& deck) const { return {{"files", static_cast<double>(deck.files.size())}}; }
  Facts operator()(const Hints& hints) const { return {{"hints", static_cast<double>(hints.hints.size())}}; }
};

struct MemoryOf {
  std::size_t operator()(const Image& image) const { return bytes_of(image.values); }
  std::size_t operator()(const Mask& mask) const { return bytes_of(mask.inside); }
  std::size_t operator()(const SurfaceMesh& mesh) const { return bytes_of(mesh); }
  std::size_t operator()(const Isosurface& isosurface) const {
    return bytes_of(isosurface.surface) + bytes_of(isosurface.block_table) + bytes_of(isosurface.blocks);
  }
  std::size_t operator()(const SimplexMesh& mesh) const {
    return bytes_of(mesh.position) + bytes_of(mesh.neighbour) + bytes_of(mesh.face) +
           bytes_of(mesh.first_vertex) + bytes_of(mesh.valence) + bytes_of(mesh.dual_position) +
           bytes_of(mesh.face_fields);
  }
  std::size_t operator()(const TetMesh& mesh) const {
    return bytes_of(mesh.points) + bytes_of(mesh.tets) + bytes_of(mesh.midside) + bytes_of(mesh.region) +
           bytes_of(mesh.boundary) + bytes_of(mesh.point_fields) + bytes_of(mesh.tet_fields);
  }
  std::size_t operator()(const QualityReport&) const { return sizeof(QualityReport); }
  std::size_t operator()(const Deck&) const { return sizeof(Deck); }
  std::size_t operator()(const Hints& hints) const { return bytes_of(hints.hints); }
};

}  // namespace

std::string_view name_of(ArtefactKind kind) {
  return kNames[static_cast<std::size_t>(kind)];
}

std::optional<ArtefactKind> kind_from_name(std::string_view name) {
  for (std::size_t kind = 0; kind < kNames.size(); ++kind) {
    if (kNames[kind] == name) return static_cast<ArtefactKind>(kind);
  }
  return std::nullopt;
}

Artefact as_surface(const Artefact& artefact) {
  const auto* isosurface = std::get_if<std::shared_ptr<const Isosurface>>(&artefact);
  if (isosurface == nullptr) return artefact;
  return std::shared_ptr<const SurfaceMesh>(*isosurface, &(*isosurface)->surface);
}

std::map<std::string, double> facts_of(const Artefact& artefact) {
  return std::visit([](const auto& value) { return FactsOf{}(*value); }, artefact);
}

std::size_t memory_bytes(const Artefact& artefact) {
  return std::visit([](const auto& value) { return MemoryOf{}(*value); }, artefact);
}

}  // namespace periost
