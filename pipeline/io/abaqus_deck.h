#pragma once
// Tetrahedral meshes as Abaqus input decks (.inp), which Abaqus and CalculiX read.
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/data/tet_mesh.h"

namespace periost {

// One face of an element: the tetrahedron and its face number S1..S4 as Abaqus counts.
struct DeckFace {
  Index tet = 0;
  int face = 1;
  friend auto operator<=>(const DeckFace&, const DeckFace&) = default;
};

// The face S1..S4 opposite to corner k of a tetrahedron.
inline constexpr int kAbaqusFace[4] = {3, 4, 2, 1};

// Writes nodes, C3D4 or C3D10 elements and sets, made to be included by a deck with material, supports and
// loads (docs/volume_mesh_and_decks.md). Node n is point n - 1 and element e is tetrahedron e - 1. Sets:
//   NALL, EALL          all nodes, all elements
//   REGION_1, ...       elements of each region
//   NBOUNDARY           nodes on the boundary, mid-side nodes included
//   BOUNDARY            surface: all faces on the boundary
//   OUTER, CAVITIES     surfaces: its pieces around bodies and around cavities (the latter if there are any)
// A comment states frame (LPS) and unit system (mm, N, MPa, tonne). Coordinates are the shortest decimals
// that read back to the same number; where these have more than CalculiX's 20 characters (numbers below 1e-4
// in magnitude) they are rounded to fit. No date; the same mesh gives the same bits; the file appears whole
// or not at all. Linear time.
// Precondition: indices valid. Throws Error{kLimit, "file.disk_full" | "file.unwritable"}.
void write_abaqus(const TetMesh& mesh, const std::filesystem::path& path);

struct AbaqusDeck {
  TetMesh mesh;  // nodes and elements in the order of the file; regions from sets called REGION_n, else 1
  std::map<std::string, std::vector<Index>> node_sets, element_sets;  // names in capitals
  std::map<std::string, std::vector<DeckFace>> surfaces;
};

// Reads nodes, C3D4 and C3D10 elements (their variants like C3D10M too) and sets (lists, GENERATE, names of
// other sets, surfaces of elements); other keywords, shells, trusses and what stands in *ASSEMBLY are
// skipped. Refused: other solids, both orders in one deck, a part that its instance moves, *INCLUDE in the
// place of the mesh. The boundary is found anew. Throws Error{kInput, "deck.malformed" | "deck.unsupported" |
// "file.unreadable"} with file and line.
AbaqusDeck read_abaqus(const std::filesystem::path& path);

}  // namespace periost
