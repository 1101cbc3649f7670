#include "stages/write_deck/write_deck.h"

#include <fmt/format.h>

#include "pipeline/base/error.h"
#include "pipeline/geometry/tet_faces.h"
#include "pipeline/io/abaqus_deck.h"
#include "pipeline/io/volume_write.h"

namespace periost {
namespace {

struct Writer {
  DeckFormat format;
  const char* ending;
  void (*write)(const TetMesh&, const std::filesystem::path&);
};
constexpr Writer kWriters[] = {{DeckFormat::kAbaqus, ".inp", &write_abaqus},
                               {DeckFormat::kVtu, ".vtu", &write_vtu}};

void check_volumes(const TetMesh& mesh) {
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    const auto& [a, b, c, d] = mesh.tets[t];
    if (six_volumes(mesh.points[a], mesh.points[b], mesh.points[c], mesh.points[d]) > 0) continue;
    const Vec3 centre = 0.25 * (mesh.points[a] + mesh.points[b] + mesh.points[c] + mesh.points[d]);
    throw Error(ErrorKind::kQuality, "deck.inverted",
                fmt::format("element {} at ({:.2f}, {:.2f}, {:.2f}) mm does not have a positive volume",
                            t + 1, centre.x, centre.y, centre.z),
                "no solver accepts it: look at the stage before");
  }
}

}  // namespace

bool is_plain_name(const std::string& name) {
  return !name.empty() && name[0] != '.' && name.find_first_of("/\\\n\r") == std::string::npos;
}

Deck write_deck(const TetMesh& mesh, const WriteDeckOptions& options, const Context& context) {
  check_volumes(mesh);
  std::string name = options.name.empty() ? context.run_name : options.name;
  if (!is_plain_name(name)) name = "mesh";
  Deck deck;
  for (const Writer& writer : kWriters) {
    for (const DeckFormat wanted : options.format) {
      if (wanted != writer.format) continue;
      const std::string file = name + writer.ending;
      writer.write(mesh, context.output / file);
      deck.files.push_back(file);
      context.info("deck.written",
                   fmt::format("{}: {} nodes, {} elements", file, mesh.points.size(), mesh.tets.size()));
      break;
    }
  }
  return deck;
}

}  // namespace periost
