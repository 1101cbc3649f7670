#include <gtest/gtest.h>

#include <optional>

#include "pipeline/base/random.h"
#include "pipeline/geometry/simplex_dual.h"
#include "pipeline/geometry/simplex_operators.h"
#include "tests/support/surfaces.h"

namespace periost {
namespace {

using test::sphere_surface;
using test::tetrahedron_surface;
using test::torus_surface;

bool same_bits(const SimplexMesh& a, const SimplexMesh& b) {
  return a.position == b.position && a.neighbour == b.neighbour && a.face == b.face &&
         a.valence == b.valence && a.first_vertex == b.first_vertex && a.dual_position == b.dual_position;
}

// Connectivity of the live part; a removed element's old row does not matter.
bool same_connectivity(const SimplexMesh& a, const SimplexMesh& b) {
  return a.neighbour == b.neighbour && a.face == b.face && a.valence == b.valence &&
         a.first_vertex == b.first_vertex;
}

std::vector<SimplexEdge> all_edges(const SimplexMesh& mesh) {
  std::vector<SimplexEdge> edges;
  for (std::uint32_t v = 0; v < mesh.face.size(); ++v) {
    for (int k = 0; k < 3 && mesh.is_live(SimplexVertex{v}); ++k) edges.push_back({SimplexVertex{v}, k});
  }
  return edges;
}

TEST(SimplexOperators, RemovalThenInsertionRestoresEveryBit) {
  const SimplexMesh original = dual_simplex_mesh(torus_surface(5, 2, 13, 7));
  int legal = 0;
  for (const SimplexEdge edge : all_edges(original)) {
    if (legality_of_removal(original, edge) != Legality::kLegal) continue;
    ++legal;
    SimplexMesh mesh = original;
    const RemovedEdge removed = remove_edge(mesh, edge);
    ASSERT_EQ(check_simplex_mesh(mesh), "");
    ASSERT_EQ(euler_number(mesh), 0);
    insert_edge(mesh, removed);
    ASSERT_TRUE(same_bits(mesh, original));
  }
  EXPECT_EQ(legal, 3 * 13 * 7 * 2);
}

TEST(SimplexOperators, SwapThenSwapBackRestoresEveryBit) {
  const SimplexMesh original = dual_simplex_mesh(torus_surface(5, 2, 13, 7));
  for (const SimplexEdge edge : all_edges(original)) {
    ASSERT_EQ(legality_of_swap(original, edge), Legality::kLegal);
    SimplexMesh mesh = original;
    const int before = topological_criterion(mesh, edge);
    const SwappedEdge swapped = swap_edge(mesh, edge);
    ASSERT_EQ(check_simplex_mesh(mesh), "");
    EXPECT_EQ(topological_criterion(mesh, swapped.edge), 4 - before);
    swap_back(mesh, swapped);
    ASSERT_TRUE(same_bits(mesh, original));
  }
}

TEST(SimplexOperators, FourSwapsOfOneEdgeAreTheIdentityOfTheSurface) {
  const SimplexMesh original = dual_simplex_mesh(sphere_surface({}, 2, 2));
  SimplexMesh mesh = original;
  SimplexEdge edge{SimplexVertex{11}, 1};
  for (int i = 0; i < 2; ++i) edge = swap_edge(mesh, edge).edge;
  EXPECT_EQ(mesh.valence, original.valence);
  EXPECT_NE(mesh.face, original.face) << "two swaps exchange the ends";
  for (int i = 0; i < 2; ++i) edge = swap_edge(mesh, edge).edge;
  EXPECT_EQ(edge.vertex, SimplexVertex{11});
  EXPECT_EQ(mesh.valence, original.valence);
}

TEST(SimplexOperators, ASwapLowersTheValenceEnergyExactlyWhenTheCriterionExceedsTwo) {
  const auto energy = [](const SimplexMesh& mesh) {
    int sum = 0;
    for (const std::uint32_t valence : mesh.valence) {
      const int off = static_cast<int>(valence) - 6;
      sum += valence == 0 ? 0 : off * off;
    }
    return sum;
  };
  SimplexMesh mesh = dual_simplex_mesh(sphere_surface({}, 2, 2));
  Random random(7, 0);
  for (int i = 0; i < 2000; ++i) {
    const SimplexEdge edge{SimplexVertex{random.below(static_cast<std::uint32_t>(mesh.face.size()))},
                           static_cast<int>(random.below(3))};
    if (legality_of_swap(mesh, edge) != Legality::kLegal) continue;
    const int d = topological_criterion(mesh, edge), before = energy(mesh);
    swap_edge(mesh, edge);
    ASSERT_EQ(energy(mesh) < before, d > 2) << "D = " << d;
  }
}

TEST(SimplexOperators, ATetrahedronRefusesEverything) {
  const SimplexMesh mesh = dual_simplex_mesh(tetrahedron_surface());
  for (const SimplexEdge edge : all_edges(mesh)) {
    EXPECT_EQ(legality_of_removal(mesh, edge), Legality::kValence);
    EXPECT_EQ(legality_of_swap(mesh, edge), Legality::kValence);
  }
}

TEST(SimplexOperators, TheLinkConditionRefusesToCloseAThinTorus) {
  // Three points around the tube: every ring is a triangle that bounds no face, so its edges must stay.
  const SimplexMesh mesh = dual_simplex_mesh(torus_surface(5, 2, 9, 3));
  int link = 0;
  for (const SimplexEdge edge : all_edges(mesh))
    link += legality_of_removal(mesh, edge) == Legality::kLink ? 1 : 0;
  EXPECT_GE(link, 2 * 9 * 3);
}

TEST(SimplexOperators, ContoursAreNotTouched) {
  SurfaceMesh surface = sphere_surface({}, 2, 2);
  surface.triangles.erase(surface.triangles.begin());
  const SimplexMesh mesh = dual_simplex_mesh(surface);
  ASSERT_EQ(check_simplex_mesh(mesh), "");
  int border = 0;
  for (const SimplexEdge edge : all_edges(mesh)) {
    const Legality removal = legality_of_removal(mesh, edge), swap = legality_of_swap(mesh, edge);
    EXPECT_EQ(removal == Legality::kBorder, swap == Legality::kBorder);
    border += removal == Legality::kBorder ? 1 : 0;
    if (removal != Legality::kLegal) continue;
    SimplexMesh copy = mesh;
    remove_edge(copy, edge);
    ASSERT_EQ(check_simplex_mesh(copy), "");
  }
  EXPECT_GT(border, 3);
}

// Thousands of random operators, each valid, half of them undone through the journal or their inverse.
void expect_random_sequence_valid(const SurfaceMesh& surface, std::uint64_t seed, int steps) {
  SimplexMesh mesh = dual_simplex_mesh(surface);
  const std::int64_t euler = euler_number(mesh);
  Random random(seed, 1);
  SimplexJournal journal;
  int removals = 0, swaps = 0;
  for (int step = 0; step < steps; ++step) {
    const SimplexEdge edge{SimplexVertex{random.below(static_cast<std::uint32_t>(mesh.face.size()))},
                           static_cast<int>(random.below(3))};
    if (!mesh.is_live(edge.vertex)) continue;
    const bool remove = random.below(4) == 0;
    const Legality legality = remove ? legality_of_removal(mesh, edge) : legality_of_swap(mesh, edge);
    if (legality != Legality::kLegal) continue;
    const std::uint32_t fate = random.below(4);  // 0: undo by journal, 1: by the inverse operator, else keep
    std::optional<SimplexMesh> before;
    if (fate < 2) before = mesh;
    std::optional<RemovedEdge> removed;
    std::optional<SwappedEdge> swapped;
    if (remove) {
      removed = remove_edge(mesh, edge, &journal);
    } else {
      swapped = swap_edge(mesh, edge, &journal);
    }
    if (step % 16 == 0) {
      ASSERT_EQ(check_simplex_mesh(mesh), "");
    }
    if (fate == 0) {
      mesh.position[index_of(edge.vertex)] += Vec3{1, 2, 3};  // both operators save this row
      journal.undo(mesh);
      ASSERT_TRUE(same_bits(mesh, *before));
    } else if (fate == 1) {
      if (removed) insert_edge(mesh, *removed, &journal);
      if (swapped) swap_back(mesh, *swapped, &journal);
      ASSERT_TRUE(same_connectivity(mesh, *before));
      SimplexMesh twice = mesh;
      journal.undo(twice);
      ASSERT_TRUE(same_bits(twice, *before));
    } else {
      (remove ? removals : swaps) += 1;
    }
    journal.clear();
  }
  ASSERT_EQ(check_simplex_mesh(mesh), "");
  EXPECT_EQ(euler_number(mesh), euler);
  EXPECT_GT(removals, 10);
  EXPECT_GT(swaps, 10);
  compact(mesh);
  EXPECT_EQ(check_simplex_mesh(mesh), "");
  EXPECT_EQ(mesh.face.size(), surface.triangles.size() - 2 * static_cast<std::size_t>(removals));
  EXPECT_EQ(mesh.valence.size(), surface.points.size() - static_cast<std::size_t>(removals));
}

TEST(SimplexOperators, RandomSequencesKeepTheMeshValid) {
  expect_random_sequence_valid(sphere_surface({1, 2, 3}, 2, 3), 1, 20000);
  expect_random_sequence_valid(torus_surface(5, 2, 24, 11), 2, 20000);
}

}  // namespace
}  // namespace periost
