#pragma once
// Leaves a surface as files in the run's output folder.
#include <string>
#include <vector>

#include "pipeline/base/context.h"
#include "pipeline/data/deck.h"
#include "pipeline/data/surface_mesh.h"
#include "pipeline/io/surface_write.h"

namespace periost {

struct WriteSurfaceOptions {
  std::vector<SurfaceFormat> format{SurfaceFormat::kStl};  // one file each
  std::string name = "surface";                            // of the files, without extension
};

// Writes context.output / NAME.FORMAT for each format and returns the files' names. Each appears whole or not
// at all. Throws Error{kLimit, "file.disk_full" | "file.unwritable"}.
Deck write_surface_files(const SurfaceMesh& surface, const WriteSurfaceOptions& options,
                         const Context& context);

}  // namespace periost
