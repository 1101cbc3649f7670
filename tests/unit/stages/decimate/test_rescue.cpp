// Patches that are taken back to the bit, and slivers mended and edges removed by many moves at once.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "certified_shapes.h"
#include "pipeline/geometry/surface_distance.h"
#include "pipeline/geometry/topology.h"
#include "stages/decimate/certified.h"
#include "stages/decimate/certified_patch.h"
#include "stages/decimate/certified_pieces.h"
#include "stages/decimate/certified_rescue.h"
#include "stages/decimate/certified_schedule.h"

namespace periost {
namespace {

constexpr double kDegree = 0.017453292519943295;

DecimateOptions at_distance(double voxels) {
  DecimateOptions options;
  options.distance = Length::voxel(voxels);
  return options;
}

// A decimated state, and a worker that has ids for insertions.
struct Bench {
  Isosurface isosurface;
  Reference reference;
  DecimateOptions options;
  CertifiedState state;
  Worker worker;

  Bench(Isosurface surface, double voxels)
      : isosurface(std::move(surface)),
        reference(isosurface),
        options(at_distance(voxels)),
        state(make_certified_state(reference, isosurface, options, Context{})) {
    run_certified_schedule(state, options, Extent::kToTheEnd, Context{});
    for (Index v = 0; v < state.mesh.points.size(); ++v) {
      state.mesh.is_locked[v] = 0;  // as left by the regions of the last sweep
      if (state.mesh.incident[v] == kNoIndex) worker.dead_points.push_back(v);
    }
    for (Index t = 0; t < state.mesh.triangles.size(); ++t) {
      if (!state.mesh.triangles[t].is_alive()) worker.dead_triangles.push_back(t);
    }
  }

  SurfaceMesh surface() const {
    SurfaceMesh mesh;
    std::vector<Index> number(state.mesh.points.size(), kNoIndex);
    for (const LinkedTriangle& t : state.mesh.triangles) {
      if (!t.is_alive()) continue;
      for (const Index v : t.corner) {
        if (number[v] != kNoIndex) continue;
        number[v] = static_cast<Index>(mesh.points.size());
        mesh.points.push_back(state.mesh.points[v]);
      }
      mesh.triangles.push_back({number[t.corner[0]], number[t.corner[1]], number[t.corner[2]]});
    }
    return mesh;
  }

  double worst_angle() const {
    double worst = 10;
    for (Index t = 0; t < state.mesh.triangles.size(); ++t) {
      if (state.mesh.triangles[t].is_alive()) worst = std::min(worst, min_angle(corners_now(state.mesh, t)));
    }
    return worst;
  }

  // Moves a vertex towards a neighbour as far as the certificates let it: the thinnest triangle that comes of
  // it.
  Index make_sliver() {
    const GuardLimits limits = worker.limits;
    worker.limits.min_angle = 1e-3;
    worker.limits.growth = std::numeric_limits<double>::max();
    worker.limits.fold_cosine = 0.1;
    Star star;
    Index sliver = kNoIndex;
    for (Index v = 0; v < state.mesh.points.size() && sliver == kNoIndex; ++v) {
      if (state.mesh.incident[v] == kNoIndex || !gather_star(state.mesh, v, star)) continue;
      const Vec3 here = state.mesh.points[v];
      const auto link = star.link;
      for (std::size_t i = 0; i < 2 * link.size() && sliver == kNoIndex; ++i) {
        const Vec3 there = state.mesh.points[link[i / 2]];
        const Vec3 place = here + (there - here) * (i % 2 == 0 ? 0.8 : 0.65);
        if (!try_relocation(state, worker, v, place, false)) continue;
        const auto slivers = find_slivers(state, 15 * kDegree);
        if (slivers.empty()) {
          try_relocation(state, worker, v, here, false);
        } else {
          sliver = slivers[0];
        }
      }
    }
    worker.limits = limits;
    return sliver;
  }
};

// Everything that a restored patch must have put back.
struct Copy {
  std::vector<LinkedTriangle> triangles;
  std::vector<Vec3> points;
  std::vector<Index> nearest, incident, first, first_labelled, next, homes;
  std::vector<std::uint8_t> valence;

  explicit Copy(const CertifiedState& state)
      : points(state.mesh.points),
        nearest(state.mesh.nearest),
        incident(state.mesh.incident),
        first(state.proofs.first),
        first_labelled(state.proofs.first_labelled),
        next(state.proofs.next),
        valence(state.mesh.valence) {
    for (Index t = 0; t < state.mesh.triangles.size(); ++t) {
      if (state.mesh.triangles[t].is_alive()) triangles.push_back(state.mesh.triangles[t]);
    }
    for (const ReverseProof& proof : state.proofs.proof) {
      homes.push_back(proof.home);
      homes.insert(homes.end(), proof.label.begin(), proof.label.end());
    }
    for (Index v = 0; v < points.size(); ++v) {  // what is dead may differ
      if (incident[v] == kNoIndex) {
        points[v] = {};
        nearest[v] = kNoIndex;
        valence[v] = 0;
      }
    }
  }
};

void expect_same(const Copy& a, const Copy& b) {
  ASSERT_EQ(a.triangles.size(), b.triangles.size());
  for (std::size_t t = 0; t < a.triangles.size(); ++t) {
    EXPECT_EQ(a.triangles[t].corner, b.triangles[t].corner);
    EXPECT_EQ(a.triangles[t].across, b.triangles[t].across);
  }
  EXPECT_EQ(a.points, b.points);
  EXPECT_EQ(a.nearest, b.nearest);
  EXPECT_EQ(a.incident, b.incident);
  EXPECT_EQ(a.valence, b.valence);
  EXPECT_EQ(a.first, b.first);
  EXPECT_EQ(a.first_labelled, b.first_labelled);
  EXPECT_EQ(a.next, b.next);
  EXPECT_EQ(a.homes, b.homes);
}

// Each isosurface triangle is listed once, at its home, which is alive, as are its labels.
void expect_sound_proofs(const CertifiedState& state) {
  std::vector<int> seen(state.proofs.proof.size(), 0);
  for (Index t = 0; t < state.mesh.triangles.size(); ++t) {
    if (!state.mesh.triangles[t].is_alive()) continue;
    state.proofs.for_homed(t, [&](Index s) {
      ++seen[s];
      EXPECT_EQ(state.proofs.proof[s].home, t);
      for (const Index label : state.proofs.proof[s].label)
        EXPECT_TRUE(label == kNoIndex || state.mesh.triangles[label].is_alive());
    });
  }
  EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), std::ptrdiff_t(seen.size()));
}

TEST(Patch, IsPutBackToTheBit) {
  Bench bench(shapes::ellipsoid(), 0.1);
  const auto points = bench.worker.dead_points, triangles = bench.worker.dead_triangles;
  ASSERT_GT(points.size(), 300U);
  const Copy before(bench.state);
  Index seed = 0;
  while (bench.state.mesh.incident[seed] == kNoIndex) ++seed;
  {
    Patch patch(bench.state, bench.worker, {seed}, 4);
    const std::size_t count = patch.triangles().size();
    ASSERT_GT(count, 40U);
    for (const double aim : {45.0, 50.0}) {
      bench.worker.limits.min_angle = aim * kDegree;
      sliver_pass(bench.state, bench.worker, patch.free_vertices());
      angle_pass(bench.state, bench.worker, patch.free_vertices(), aim * kDegree);
      const MoveCounts& counts = bench.worker.counts;
      EXPECT_GT(counts.moves(), 0U);
      EXPECT_EQ(patch.triangles().size() + 2 * counts.removals, count + 2 * counts.insertions);
      EXPECT_NE(Copy(bench.state).points, before.points);
      patch.restore();
      EXPECT_EQ(bench.worker.counts.moves(), 0U);
      EXPECT_EQ(patch.triangles().size(), count);
      expect_same(Copy(bench.state), before);
    }
  }
  EXPECT_EQ(bench.worker.dead_points, points);
  EXPECT_EQ(bench.worker.dead_triangles, triangles);
  EXPECT_EQ(std::count(bench.state.mesh.is_locked.begin(), bench.state.mesh.is_locked.end(), 0),
            std::ptrdiff_t(bench.state.mesh.is_locked.size()));
}

TEST(Patch, LeavesItsBorderAlone) {
  Bench bench(shapes::ellipsoid(), 0.1);
  const std::vector<Index> incident = bench.state.mesh.incident;
  Index seed = 0;
  while (incident[seed] == kNoIndex) ++seed;
  const std::vector<Vec3> before = bench.state.mesh.points;
  std::vector<Index> inside;
  {
    Patch patch(bench.state, bench.worker, {seed}, 3);
    inside = patch.free_vertices();
    bench.worker.limits.min_angle = 50 * kDegree;
    sliver_pass(bench.state, bench.worker, patch.free_vertices());
    EXPECT_GT(bench.worker.counts.moves(), 0U);
  }
  for (Index v = 0; v < before.size(); ++v) {
    if (incident[v] == kNoIndex || std::binary_search(inside.begin(), inside.end(), v)) continue;
    EXPECT_EQ(bench.state.mesh.points[v], before[v]);
    EXPECT_NE(bench.state.mesh.incident[v], kNoIndex);
  }
  expect_sound_proofs(bench.state);
}

class Rescue : public testing::TestWithParam<double> {};

TEST_P(Rescue, MendsASliverWithinTheDistance) {
  Bench bench(shapes::ellipsoid(), GetParam());
  const Index sliver = bench.make_sliver();
  ASSERT_NE(sliver, kNoIndex);
  ASSERT_LT(bench.worst_angle(), 15 * kDegree);
  rescue_slivers(bench.state, bench.worker, 15 * kDegree, 2, Context{});
  EXPECT_GT(bench.worst_angle(), 20 * kDegree);
  expect_sound_proofs(bench.state);
  const SurfaceMesh result = bench.surface();
  const Topology topology = examine_topology(result), was = examine_topology(bench.isosurface.surface);
  EXPECT_TRUE(topology.is_closed());
  EXPECT_TRUE(topology.is_manifold());
  EXPECT_EQ(topology.euler, was.euler);
  const auto both = two_sided_distance(result, bench.isosurface.surface, {}, Context{});
  const double tolerance = GetParam() * bench.isosurface.frame.largest_spacing();
  EXPECT_LE(both.forward.summary.max, tolerance);
  EXPECT_LE(both.backward.summary.max, tolerance);
}

INSTANTIATE_TEST_SUITE_P(Distances, Rescue, testing::Values(0.06, 0.1));

TEST(RescueSlivers, ChangesNothingWithoutRecipesOrSlivers) {
  Bench bench(shapes::ellipsoid(), 0.1);
  const Copy clean(bench.state);
  rescue_slivers(bench.state, bench.worker, 15 * kDegree, 9, Context{});
  expect_same(Copy(bench.state), clean);
  ASSERT_NE(bench.make_sliver(), kNoIndex);
  const Copy before(bench.state);
  rescue_slivers(bench.state, bench.worker, 15 * kDegree, 0, Context{});
  expect_same(Copy(bench.state), before);
}

}  // namespace
}  // namespace periost
