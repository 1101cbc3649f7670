#include "stages/write_surface/write_surface.h"

namespace periost {

Deck write_surface_files(const SurfaceMesh& surface, const WriteSurfaceOptions& options,
                         const Context& context) {
  Deck deck;
  for (const SurfaceFormat format : options.format) {
    const std::string file = options.name + "." + name_of(format);
    write_surface(surface, context.output / file, format);
    deck.files.push_back(file);
  }
  return deck;
}

}  // namespace periost
