#pragma once
// The topological operators of the decimator on a simplex mesh (Delingette 1994; 1997, figure 3 c and d).
// They change connectivity only: positions are the caller's. All are local, O(valence), keep three neighbours
// at every vertex and leave the Euler number unchanged.
//
// Names used below, for the edge from v to w: its two adjacent faces `left` and `right` (counter-clockwise at
// v: opposite_v, left, right), its opposite faces `opposite_v` (of v alone) and `opposite_w` (of w alone). In
// the dual triangulation it is the edge between left and right, and the other two are the opposite corners.
#include <cstddef>
#include <vector>

#include "pipeline/data/simplex_mesh.h"
#include "pipeline/geometry/simplex_walk.h"

namespace periost {

struct EdgeFaces {
  SimplexFace left, right, opposite_v, opposite_w;
};
// Precondition: the edge has two ends.
EdgeFaces faces_of(const SimplexMesh& mesh, SimplexEdge edge);

// The signed topological criterion D = (valences of the adjacent faces) - (valences of the opposite ones);
// the paper's criterion is |D| <= T. A swap lowers the sum of (valence - 6)^2 over the faces exactly when D
// > 2.
int topological_criterion(const SimplexMesh& mesh, SimplexEdge edge);

// Why an operator is refused. Faces cut by a contour are never touched.
enum class Legality { kLegal, kBorder, kValence, kLink };

// T1/2 merges left and right: v and w vanish. Legal if left and right have no common neighbouring face but
// the two opposite ones (so no two faces come to share two edges) and every face keeps at least three
// vertices.
Legality legality_of_removal(const SimplexMesh& mesh, SimplexEdge edge);
// T7/2 turns the edge: left and right lose a vertex, the opposite faces gain one and come to share the edge.
// Legal if those two do not share an edge yet and left and right keep at least three vertices.
Legality legality_of_swap(const SimplexMesh& mesh, SimplexEdge edge);

// Old values of every row about to change, so that `undo` restores every bit.
class SimplexJournal {
 public:
  void save(const SimplexMesh& mesh, SimplexVertex v);
  void save(const SimplexMesh& mesh, SimplexFace f);
  // Restores everything saved since the journal was empty, and empties it.
  void undo(SimplexMesh& mesh);
  // Keeps the changes.
  void clear();
  bool is_empty() const { return vertices_.empty() && faces_.empty(); }

 private:
  struct VertexRow {
    SimplexVertex vertex;
    Vec3 position;
    std::array<SimplexVertex, 3> neighbour;
    std::array<SimplexFace, 3> face;
  };
  struct FaceRow {
    SimplexFace face;
    SimplexVertex first_vertex;
    std::uint32_t valence;
    Vec3 dual_position;
  };
  std::vector<VertexRow> vertices_;
  std::vector<FaceRow> faces_;
};

// What T1/2 took away: enough for T2/2 to put it back.
struct RemovedEdge {
  SimplexEdge edge;  // v and its slot
  SimplexVertex w = kNoVertex;
  EdgeFaces faces{};  // left is the merged face, right is dead
  std::array<SimplexVertex, 3> neighbour_v{}, neighbour_w{};
  std::array<SimplexFace, 3> face_v{}, face_w{};
  std::array<SimplexVertex, 4> first{};  // of left, right, opposite_v, opposite_w
  std::uint32_t right_valence = 0;
};

// T1/2: removes the edge and its two ends; `left` becomes the merged face, `right` dies. dual_position is
// left as it was. With a journal, every row is saved before it changes. Precondition: the removal is legal.
RemovedEdge remove_edge(SimplexMesh& mesh, SimplexEdge edge, SimplexJournal* journal = nullptr);

// T2/2, the inverse: puts the edge back. Precondition: since `removed` was made, connectivity around the
// merged face has been restored to what it was. Restores every bit of connectivity.
void insert_edge(SimplexMesh& mesh, const RemovedEdge& removed, SimplexJournal* journal = nullptr);

// What T7/2 did: the edge as it lies now, named from v, and what swap_back needs.
struct SwappedEdge {
  SimplexEdge edge;
  EdgeFaces faces{};                     // as they were named before the swap
  std::array<SimplexVertex, 4> first{};  // of left, right, opposite_v, opposite_w
};

// T7/2. Afterwards v lies on opposite_v, left and opposite_w, and w on opposite_w, right and opposite_v, in
// that cyclic order. Precondition: the swap is legal.
SwappedEdge swap_edge(SimplexMesh& mesh, SimplexEdge edge, SimplexJournal* journal = nullptr);

// The inverse turn, which restores every bit of connectivity. (A second swap_edge restores the surface too,
// but with v and w exchanged.) Precondition: as for insert_edge.
void swap_back(SimplexMesh& mesh, const SwappedEdge& swapped, SimplexJournal* journal = nullptr);

}  // namespace periost
