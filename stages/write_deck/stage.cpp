#include "pipeline/stage/stage.h"
#include "stages/write_deck/write_deck.h"

namespace periost {

static std::vector<Choice<DeckFormat>> choices_of(DeckFormat) {
  return {{DeckFormat::kAbaqus, "abaqus", "NAME.inp for Abaqus and CalculiX, with sets and surfaces."},
          {DeckFormat::kVtu, "vtu", "NAME.vtu for ParaView and other programs that use VTK."}};
}

namespace {

class WriteDeckStage final : public StageOf<WriteDeckOptions> {
 public:
  void declare(Declaration<WriteDeckOptions>& d) const override {
    d.stage("write_deck", 1, "Writes the tetrahedral mesh for solvers.")
        .input<TetMesh>("tet_mesh", "The mesh to write.")
        .output<Deck>("deck", "The files that were written.")
        .param("format", &WriteDeckOptions::format, Quantity::kNone, Range::any(), "Formats, one file each.")
        .param("name", &WriteDeckOptions::name, Quantity::kNone, Range::any(),
               "Name of the files without ending; left empty, the name of the run.");
  }

  void preflight(const WriteDeckOptions& options, Preflight& preflight) const override {
    if (options.format.empty()) {
      preflight.error("config.out_of_range", "format", "no format is given", "for example format: [abaqus]");
    }
    if (!options.name.empty() && !is_plain_name(options.name)) {
      preflight.error("config.out_of_range", "name", "the name of a file may not hold separators",
                      "files go into the folder that --out names");
    }
  }

  Outputs run(const WriteDeckOptions& options, const Inputs& inputs, Context& context) const override {
    return {write_deck(inputs.get<TetMesh>("tet_mesh"), options, context)};
  }
};

}  // namespace
}  // namespace periost

PERIOST_STAGE(write_deck, periost::WriteDeckStage)
