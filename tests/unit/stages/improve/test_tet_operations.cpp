#include <gtest/gtest.h>

#include <set>
#include <utility>

#include "stages/improve/tet_cavity.h"
#include "stages/improve/tet_complex.h"
#include "stages/improve/tet_order.h"
#include "stages/improve/tet_removal.h"
#include "stages/improve/tet_smoothing.h"
#include "stages/improve/thin_split.h"
#include "tests/unit/stages/improve/improve_shapes.h"

namespace periost {
namespace {

using test::bricks;

constexpr std::size_t kAnyRoom = 1000000;

double volume6(const TetComplex& complex) {
  double sum = 0;
  for (Index t = 0; t < complex.corners.size(); ++t) {
    if (!complex.is_live(t)) continue;
    const auto& [a, b, c, d] = complex.corners[t];
    sum += six_volumes(complex.position[a], complex.position[b], complex.position[c], complex.position[d]);
  }
  return sum;
}

std::vector<Triangle> walls(const TetComplex& complex) {
  std::vector<Triangle> faces;
  for (Index t = 0; t < complex.corners.size(); ++t) {
    for (int side = 0; complex.is_live(t) && side < 4; ++side) {
      if (complex.neighbours[t][as_size(side)] == kNoIndex)
        faces.push_back(face_of(complex.corners[t], side));
    }
  }
  return test::sorted_boundary(faces);
}

double least(const TetComplex& complex) {
  double value = 2;
  for (Index t = 0; t < complex.corners.size(); ++t) {
    if (complex.is_live(t)) value = std::min(value, complex.quality[t]);
  }
  return value;
}

TEST(TetComplex, HoldsTheMesh) {
  const TetMesh mesh = bricks(3, 0.3, 1);
  TetComplex complex(mesh);
  EXPECT_EQ(check_complex(complex), "");
  EXPECT_EQ(complex.live, mesh.tets.size());
  EXPECT_EQ(walls(complex), test::sorted_boundary(mesh.boundary));
  std::vector<Index> star;
  for (Index p = 0; p < mesh.points.size(); ++p) {
    complex.star(p, star);
    std::set<Index> expected;
    for (Index t = 0; t < mesh.tets.size(); ++t) {
      if (complex.has_corner(t, p)) expected.insert(t);
    }
    EXPECT_EQ(std::set<Index>(star.begin(), star.end()), expected);
    EXPECT_EQ(star.size(), expected.size());
  }
}

TEST(TetComplex, RingsCloseInsideAndNotOnWalls) {
  const TetMesh mesh = bricks(3, 0.2, 2);
  TetComplex complex(mesh);
  std::vector<Index> ring, points;
  std::set<std::pair<Index, Index>> on_walls;
  for (const Triangle& t : mesh.boundary) {
    for (std::size_t i = 0; i < 3; ++i) on_walls.insert(std::minmax(t[i], t[(i + 1) % 3]));
  }
  for (Index t = 0; t < mesh.tets.size(); ++t) {
    for (const auto& [i, j] : kTetEdge) {
      const Index a = mesh.tets[t][as_size(i)], b = mesh.tets[t][as_size(j)];
      const bool is_closed = complex.ring(t, a, b, 100, ring, points);
      ASSERT_EQ(is_closed, !on_walls.contains(std::minmax(a, b)));
      for (std::size_t k = 0; is_closed && k < ring.size(); ++k) {
        const Vec3 from = mesh.points[points[k]], to = mesh.points[points[(k + 1) % ring.size()]];
        EXPECT_GT(six_volumes(mesh.points[a], mesh.points[b], from, to), 0);
        EXPECT_TRUE(complex.has_corner(ring[k], points[k]));
      }
    }
  }
}

TEST(TetComplex, AReplacementThatDoesNotFitChangesNothing) {
  const TetMesh mesh = bricks(2, 0.1, 3);
  TetComplex complex(mesh);
  const Tetrahedron one = mesh.tets[0];
  EXPECT_FALSE(complex.replace({0}, {mesh.tets[1]}));
  EXPECT_FALSE(complex.replace({0}, {one, one}));
  EXPECT_FALSE(complex.replace({0, 0}, {one}));
  EXPECT_FALSE(complex.replace({0, 1}, {one}));
  EXPECT_FALSE(complex.replace({0}, {}));
  EXPECT_EQ(check_complex(complex), "");
  EXPECT_EQ(complex.corners, mesh.tets);
  EXPECT_EQ(complex.version, std::vector<std::uint32_t>(mesh.tets.size(), 0));
  EXPECT_TRUE(complex.replace({0}, {{one[1], one[2], one[0], one[3]}}));
  EXPECT_EQ(check_complex(complex), "");
}

TEST(TetComplex, SlotsAreUsedAgain) {
  TetComplex complex(test::octahedron_with_sliver(0.2));
  TetRemoval removal(complex);
  ASSERT_TRUE(removal.remove_any(0, kAnyRoom));
  EXPECT_EQ(complex.live, 4u);
  EXPECT_EQ(check_complex(complex), "");
  const Index point = complex.add_point({0, 0, 0.05});
  std::vector<Index> old;
  std::vector<Tetrahedron> fresh;
  for (Index t = 0; t < complex.corners.size(); ++t) {
    if (!complex.is_live(t)) continue;
    old.push_back(t);
    for (int side = 0; side < 4; ++side) {
      if (complex.neighbours[t][as_size(side)] != kNoIndex) continue;
      const auto [a, b, c] = face_of(complex.corners[t], side);
      fresh.push_back({a, c, b, point});
    }
  }
  ASSERT_TRUE(complex.replace(old, fresh));
  EXPECT_EQ(complex.live, 8u);
  EXPECT_EQ(complex.corners.size(), 8u);
  EXPECT_EQ(check_complex(complex), "");
}

// Every kind of change, wherever it is taken: the mesh stays valid, the walls stay, the worst never gets
// worse.
TEST(TetOperations, KeepTheMeshValidAndRaiseTheWorst) {
  const TetMesh mesh = bricks(4, 0.45, 7, 2);
  TetComplex complex(mesh);
  const double volume = volume6(complex);
  const std::vector<Triangle> first_walls = walls(complex);
  TetRemoval removal(complex);
  TetSmoothing smoothing(complex);
  TetCavity cavity(complex);
  int removed = 0, smoothed = 0, inserted = 0;
  for (int round = 0; round < 3; ++round) {
    for (Index t = 0; t < complex.corners.size(); ++t) {
      if (!complex.is_live(t) || complex.quality[t] > 0.5) continue;
      const double before = least(complex);
      const Tetrahedron corners = complex.corners[t];
      bool has_changed = true;
      if (removal.remove_any(t, kAnyRoom)) {
        ++removed;
      } else if (smoothing.smooth(corners[0], 0.6) || smoothing.smooth(corners[1], 0.6)) {
        ++smoothed;
      } else if (cavity.insert(t, 0.6, kAnyRoom, 0)) {
        ++inserted;
      } else {
        has_changed = false;
      }
      if (has_changed) {
        ASSERT_EQ(check_complex(complex), "");
        ASSERT_GE(least(complex), before);
      }
    }
  }
  EXPECT_GT(removed, 10);
  EXPECT_GT(smoothed, 10);
  EXPECT_GT(inserted, 0);
  EXPECT_NEAR(volume6(complex), volume, 1e-10 * volume);
  EXPECT_EQ(walls(complex), first_walls);
}

TEST(TetOperations, AFoundCavityIsStaleOnceItChanged) {
  const TetMesh mesh = bricks(4, 0.45, 11);
  TetComplex complex(mesh);
  TetCavity first(complex), again(complex);
  std::size_t made = 0;
  for (Index t = 0; t < mesh.tets.size(); ++t) {
    if (!complex.is_live(t) || complex.quality[t] >= 0.5 || !first.find(t, 0.6, kAnyRoom, 0)) continue;
    const double before = least(complex);
    ASSERT_TRUE(again.find(t, 0.6, kAnyRoom, 0)) << "a search changes nothing";
    ASSERT_TRUE(first.is_current() && again.is_current());
    const auto live = static_cast<std::ptrdiff_t>(complex.live);
    const std::ptrdiff_t growth = first.growth();
    ASSERT_TRUE(first.make());
    ++made;
    EXPECT_EQ(static_cast<std::ptrdiff_t>(complex.live), live + growth);
    EXPECT_FALSE(again.is_current());
    EXPECT_GE(least(complex), before);
  }
  EXPECT_GT(made, 0U);
  EXPECT_EQ(check_complex(complex), "");
}

TEST(TetOrder, IsTheSameMeshWithNeighboursNear) {
  const TetMesh mesh = bricks(6, 0.3, 5, 3);
  const TetMesh ordered = in_curve_order(mesh);
  EXPECT_EQ(ordered.points, mesh.points);
  const auto sorted = [](const TetMesh& m) {
    std::vector<std::pair<Tetrahedron, std::int32_t>> tets;
    for (std::size_t t = 0; t < m.tets.size(); ++t) tets.emplace_back(m.tets[t], m.region[t]);
    std::sort(tets.begin(), tets.end());
    return tets;
  };
  EXPECT_EQ(sorted(ordered), sorted(mesh));
  // Shuffled before, it comes out the same.
  TetMesh shuffled = mesh;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    const std::size_t from = (t * 7919 + 13) % mesh.tets.size();  // a prime, no divisor of the number
    shuffled.tets[t] = mesh.tets[from];
    shuffled.region[t] = mesh.region[from];
  }
  ASSERT_EQ(sorted(shuffled), sorted(mesh));
  EXPECT_EQ(in_curve_order(shuffled).tets, ordered.tets);
}

TEST(TetOperations, NoRoomNoGrowth) {
  const TetMesh mesh = bricks(4, 0.45, 11);
  TetComplex complex(mesh);
  TetRemoval removal(complex);
  TetCavity cavity(complex);
  for (Index t = 0; t < mesh.tets.size(); ++t) {
    if (complex.is_live(t) && complex.quality[t] < 0.5 && !removal.remove_any(t, 0))
      cavity.insert(t, 0.6, 0, 0);
    ASSERT_LE(complex.live, mesh.tets.size());
  }
}

TEST(TetSmoothing, LeavesWallsAndGoodStars) {
  TetComplex complex(bricks(3, 0.3, 4));
  TetSmoothing smoothing(complex);
  for (Index p = 0; p < complex.position.size(); ++p) {
    const Vec3 kept = complex.position[p];
    EXPECT_FALSE(smoothing.smooth(p, -1));
    if (complex.is_on_wall[p] != 0) {
      EXPECT_FALSE(smoothing.smooth(p, 1));
    }
    EXPECT_EQ(complex.position[p], kept);
  }
}

TEST(ThinSplit, PutsPointsBetweenTheTwoSides) {
  // One layer of bricks: every point is on the boundary.
  TetMesh mesh = bricks(1, 0, 0);
  TetComplex complex(mesh);
  const double volume = volume6(complex);
  EXPECT_EQ(split_thin_walls(complex, 5), 0u) << "no room";
  EXPECT_EQ(split_thin_walls(complex, kAnyRoom), 1u) << "the diagonal of the brick";
  EXPECT_EQ(check_complex(complex), "");
  EXPECT_EQ(complex.live, 12u);
  EXPECT_NEAR(volume6(complex), volume, 1e-12 * volume);
  EXPECT_EQ(walls(complex), test::sorted_boundary(mesh.boundary));
}

}  // namespace
}  // namespace periost
