#include "pipeline/run/artefact_files.h"

#include <array>

#include "pipeline/base/error.h"
#include "pipeline/io/image_write.h"
#include "pipeline/io/quality_json.h"
#include "pipeline/io/simplex_write.h"
#include "pipeline/io/surface_write.h"
#include "pipeline/io/volume_write.h"

namespace periost {
namespace {

namespace fs = std::filesystem;

template <class T>
const T& value_of(const Artefact& artefact) {
  return *std::get<std::shared_ptr<const T>>(artefact);
}

struct KindFile {
  const char* name;
  bool always;
  void (*write)(const Artefact& artefact, const fs::path& path);
};

// In the order of ArtefactKind.
const std::array<KindFile, kArtefactKinds> kFiles{{
    {"image.nii.gz", false,
     [](const Artefact& a, const fs::path& path) { write_image(path, value_of<Image>(a)); }},
    {"mask.nii.gz", false,
     [](const Artefact& a, const fs::path& path) { write_mask(path, value_of<Mask>(a)); }},
    {"isosurface.vtp", false,
     [](const Artefact& a, const fs::path& path) { write_surface(value_of<Isosurface>(a).surface, path); }},
    {"simplex_mesh.vtp", false,
     [](const Artefact& a, const fs::path& path) { write_simplex_vtp(value_of<SimplexMesh>(a), path); }},
    {"surface.vtp", true,
     [](const Artefact& a, const fs::path& path) { write_surface(value_of<SurfaceMesh>(a), path); }},
    {"volume.vtu", true,
     [](const Artefact& a, const fs::path& path) { write_vtu(value_of<TetMesh>(a), path); }},
    {"quality.json", true,
     [](const Artefact& a, const fs::path& path) { write_quality_json(value_of<QualityReport>(a), path); }},
    {"", false, nullptr},
    {"hints.json", false,
     [](const Artefact& a, const fs::path& path) { write_hints_json(value_of<Hints>(a), path); }},
}};

const KindFile& file_of(ArtefactKind kind) {
  return kFiles[static_cast<std::size_t>(kind)];
}

}  // namespace

std::string file_name_of(ArtefactKind kind) {
  return file_of(kind).name;
}

bool is_always_saved(ArtefactKind kind) {
  return file_of(kind).always;
}

std::vector<std::string> saveable_kinds() {
  std::vector<std::string> names;
  for (int kind = 0; kind < kArtefactKinds; ++kind) {
    const auto k = static_cast<ArtefactKind>(kind);
    if (file_of(k).write != nullptr) names.emplace_back(name_of(k));
  }
  return names;
}

void write_artefact_file(const Artefact& artefact, const fs::path& folder) {
  const KindFile& file = file_of(kind_of(artefact));
  PERIOST_ASSERT(file.write != nullptr);
  file.write(artefact, folder / file.name);
}

}  // namespace periost
