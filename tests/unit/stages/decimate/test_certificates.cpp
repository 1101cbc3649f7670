// The certificates never accept what dense sampling refutes, on random configurations, and do accept what is
// plainly right. Distances are measured by brute force over all triangles.
#include <gtest/gtest.h>

#include <algorithm>

#include "certified_shapes.h"
#include "pipeline/geometry/closest_point.h"
#include "stages/decimate/certificate_forward.h"
#include "stages/decimate/certificate_reverse.h"
#include "stages/decimate/certificate_ring.h"

namespace periost {
namespace {

Vec3 random_vector(Random& random, double size) {
  return Vec3{random.uniform() - 0.5, random.uniform() - 0.5, random.uniform() - 0.5} * (2 * size);
}

double brute_distance(const Reference& reference, Vec3 p) {
  double best = 1e300;
  for (Index t = 0; t < reference.triangles.size(); ++t) {
    best = std::min(best, squared_distance(p, reference.corners(t)));
  }
  return std::sqrt(best);
}

double sampled_distance(const Reference& reference, const std::array<Vec3, 3>& t, int steps) {
  double worst = 0;
  for (int i = 0; i <= steps; ++i) {
    for (int j = 0; i + j <= steps; ++j) {
      const double u = double(i) / steps, v = double(j) / steps;
      worst = std::max(worst, brute_distance(reference, t[0] + (t[1] - t[0]) * u + (t[2] - t[0]) * v));
    }
  }
  return worst;
}

// A triangle with corners near the surface, a few edges apart.
DualTriangle random_triangle(const Reference& reference, Random& random, double noise) {
  DualTriangle triangle{};
  Index t = random.below(static_cast<std::uint32_t>(reference.triangles.size()));
  for (std::size_t k = 0; k < 3; ++k) {
    triangle.nearest[k] = t;
    triangle.corner[k] = reference.points[reference.triangles[t].corner[k]] + random_vector(random, noise);
    for (int step = 0; step < 5; ++step) t = reference.triangles[t].across[random.below(3)];
  }
  return triangle;
}

TEST(SquaredDistance, IsThatOfTheClosestPointForTrianglesOfAllShapes) {
  Random random(19, 0);
  for (const double height : {1.0, 0.2, 1e-3, 1e-6, 0.0}) {
    for (int trial = 0; trial < 2000; ++trial) {
      const Vec3 a = random_vector(random, 100), b = a + random_vector(random, 2);
      // Beside, over and beyond the edge a b: acute, obtuse, and flat in the end.
      const Vec3 c = a + (b - a) * (3 * random.uniform() - 1) + random_vector(random, height);
      const Vec3 p = a + random_vector(random, 4);
      const double expected = squared_norm(p - closest_point_on_triangle(p, a, b, c));
      EXPECT_NEAR(squared_distance(p, {a, b, c}), expected, 1e-9 * (1 + expected)) << "height " << height;
    }
  }
}

TEST(Reference, NearestAndWithinAgreeWithBruteForce) {
  const Reference reference(shapes::ellipsoid());
  Random random(3, 0);
  std::vector<Index> found;
  for (int trial = 0; trial < 200; ++trial) {
    const Index v = random.below(static_cast<std::uint32_t>(reference.points.size()));
    const Vec3 p = reference.points[v] + random_vector(random, 0.8);
    const double radius = 0.2 + random.uniform();
    double best = radius;
    std::size_t count = 0;
    for (Index t = 0; t < reference.triangles.size(); ++t) {
      const double d = std::sqrt(squared_distance(p, reference.corners(t)));
      if (d <= radius) ++count;
      if (dot(reference.normals[t], Vec3{0, 0, 1}) > 0) best = std::min(best, d);
    }
    const auto nearest = reference.nearest(p, radius, {0, 0, 1});
    EXPECT_EQ(nearest.triangle == kNoIndex, best == radius);
    if (nearest.triangle != kNoIndex) {
      EXPECT_NEAR(std::sqrt(nearest.squared_distance), best, 1e-12);
    }
    reference.within(p, radius, found);
    EXPECT_EQ(found.size(), count);
  }
}

TEST(Reference, NeighboursAreMutual) {
  const Reference reference(shapes::stairs());
  for (Index t = 0; t < reference.triangles.size(); ++t) {
    for (const Index other : reference.triangles[t].across) {
      ASSERT_NE(other, kNoIndex);
      const auto& back = reference.triangles[other].across;
      EXPECT_EQ(std::count(back.begin(), back.end(), t), 1);
    }
  }
}

class ForwardCertificate : public testing::TestWithParam<double> {};

TEST_P(ForwardCertificate, NeverAcceptsWhatSamplesRefute) {
  const Reference reference(shapes::stairs());
  Random random(11, 0);
  ForwardScratch scratch;
  const double tolerance = GetParam();
  int accepted = 0, refused = 0;
  for (int trial = 0; trial < 100; ++trial) {
    const DualTriangle triangle = random_triangle(reference, random, 0.7 * tolerance);
    const auto& c = triangle.corner;
    if (squared_norm(cross(c[1] - c[0], c[2] - c[0])) < 1e-6) continue;
    if (!certify_forward(reference, triangle, tolerance, scratch)) {
      ++refused;
      continue;
    }
    ++accepted;
    EXPECT_LE(sampled_distance(reference, c, 12), tolerance * (1 + 1e-9));
  }
  EXPECT_GT(accepted, 10);
  EXPECT_GT(refused, 5);
}
INSTANTIATE_TEST_SUITE_P(Tolerances, ForwardCertificate, testing::Values(0.2, 0.4));

TEST(ForwardCertificate, EachStepIsSoundByItself) {
  const Reference reference(shapes::ellipsoid());
  Random random(5, 1);
  ForwardScratch scratch;
  int overlay = 0, bisection = 0, refuted = 0;
  for (int trial = 0; trial < 120; ++trial) {
    const DualTriangle triangle = random_triangle(reference, random, 0.25);
    const auto& c = triangle.corner;
    const Vec3 own = normalized(cross(c[1] - c[0], c[2] - c[0]));
    if (own == Vec3{}) continue;
    const Answer answer = certify_by_overlay(reference, triangle, own, 0.3, scratch);
    const bool by_overlay = answer == Answer::kProved;
    const bool by_bisection = certify_by_bisection(reference, c, 0.3, 9, scratch);
    overlay += by_overlay;
    refuted += answer == Answer::kRefuted;
    EXPECT_FALSE(answer == Answer::kRefuted && by_bisection);
    bisection += by_bisection;
    if (by_overlay || by_bisection) {
      EXPECT_LE(sampled_distance(reference, c, 10), 0.3 * (1 + 1e-9));
    }
    // Flat along its own direction and accepted there, it lies within the tolerance, which bisection can see
    // but for limit cases; never the other way round with the sense of rotation reversed.
    DualTriangle reversed = triangle;
    std::swap(reversed.corner[0], reversed.corner[1]);
    EXPECT_FALSE(by_overlay &&
                 certify_by_overlay(reference, reversed, -own, 0.3, scratch) == Answer::kProved);
  }
  EXPECT_GT(overlay, 5);
  EXPECT_GT(refuted, 1);
  EXPECT_GE(bisection, overlay);
}

TEST(ForwardCertificate, AcceptsTheSurfaceItself) {
  const Reference reference(shapes::stairs());
  ForwardScratch scratch;
  for (Index t = 0; t < reference.triangles.size(); t += 3) {
    EXPECT_EQ(
        certify_by_overlay(reference, {reference.corners(t), {t, t, t}}, reference.normals[t], 1e-3, scratch),
        Answer::kProved);
  }
}

TEST(ForwardCertificate, AHoleUnderTheTriangleIsNotCovered) {
  // A large triangle over one small component of noise: its corners are far, nothing covers it.
  const Reference reference(shapes::white_noise(4));
  ForwardScratch scratch;
  const auto c = reference.corners(0);
  const Vec3 middle = (c[0] + c[1] + c[2]) / 3;
  DualTriangle large{{}, {0, 0, 0}};
  for (std::size_t k = 0; k < 3; ++k) large.corner[k] = middle + (c[k] - middle) * 200;
  EXPECT_FALSE(certify_forward(reference, large, 0.3, scratch));
}

// The distance from a point to the output after a proposal, by brute force.
double distance_to_mesh(const CertifiedMesh& mesh, const Proposal& proposal, Vec3 p) {
  double best = 1e300;
  for (Index t = 0; t < mesh.triangles.size(); ++t) {
    const bool is_gone = proposal.before.contains(t) && !proposal.after.contains(t);
    if (!mesh.triangles[t].is_alive() || is_gone) continue;
    const auto& c = proposal.cell_of(mesh, t).corner;
    best = std::min(best, squared_distance(p, {proposal.point_of(mesh, c[0]), proposal.point_of(mesh, c[1]),
                                               proposal.point_of(mesh, c[2])}));
  }
  return std::sqrt(best);
}

std::vector<Index> around(const CertifiedMesh& mesh, const Proposal& proposal) {
  std::vector<Index> result;
  for (Index t = 0; t < mesh.triangles.size(); ++t) {
    if (!mesh.triangles[t].is_alive() || proposal.before.contains(t)) continue;
    for (const Index v : mesh.triangles[t].corner) {
      if (!proposal.rim.contains(v)) continue;
      result.push_back(t);
      break;
    }
  }
  return result;
}

// Removals and swaps at random places, on a mesh that is decimated as far as the overlay allows.
TEST(RingCertificate, NeverProvesWhatSamplesRefute) {
  const Reference reference(shapes::stairs());
  CertifiedMesh mesh = make_certified_mesh(reference);
  RingScratch scratch;
  ForwardScratch forward;
  Proposal proposal;
  Random random(21, 0);
  const double tolerance = 0.3;
  int proved = 0, left_open = 0, refuted = 0, swaps = 0;
  for (int trial = 0; trial < 4000 && proved < 400; ++trial) {
    const Index t = random.below(static_cast<std::uint32_t>(mesh.triangles.size()));
    const bool is_swap = trial % 5 == 0;
    if (!mesh.triangles[t].is_alive()) continue;
    if (!(is_swap ? propose_swap(mesh, t, random.below(3), proposal)
                  : propose_removal(mesh, t, random.below(3), proposal))) {
      continue;
    }
    if (!is_swap) {
      proposal.place =
          (mesh.points[proposal.moved] + mesh.points[proposal.removed]) / 2 + random_vector(random, 0.1);
      proposal.place_nearest = reference.nearest(proposal.place, 1, {}).triangle;
      if (proposal.place_nearest == kNoIndex) proposal.place_nearest = mesh.nearest[proposal.moved];
    }
    const Answer answer = certify_ring(reference, mesh, proposal, tolerance, forward, scratch);
    refuted += answer == Answer::kRefuted ? 1 : 0;
    if (answer != Answer::kProved) continue;
    for (const LinkedTriangle& cell : proposal.cells) {
      if (trial % 4 != 0 && !is_swap) break;  // brute force takes its time
      EXPECT_LE(sampled_distance(reference, corners_after(mesh, proposal, cell), 4), tolerance * (1 + 1e-9));
    }
    left_open += scratch.unproved != 0 ? 1 : 0;
    ++proved;
    swaps += is_swap ? 1 : 0;
    apply(proposal, mesh);
  }
  EXPECT_EQ(proved, 400);
  EXPECT_GT(swaps, 10);
  EXPECT_GT(left_open, 10);
  EXPECT_GT(refuted, 5);
}

// On the untouched mesh a ring's border is made of the isosurface's edges: nothing beyond is looked at, and
// all inside is covered though it has corners on the border.
TEST(RingCertificate, EndsWhereTheFansBorderIsTheIsosurfaces) {
  const Reference reference(shapes::ellipsoid());
  const CertifiedMesh mesh = make_certified_mesh(reference);
  RingScratch scratch;
  ForwardScratch forward;
  Proposal proposal;
  int proved = 0, covered = 0, inside = 0;
  for (Index t = 0; t < mesh.triangles.size(); t += 7) {
    if (!(t % 2 == 0 ? propose_swap(mesh, t, 1, proposal) : propose_removal(mesh, t, 1, proposal))) continue;
    if (proposal.moved != kNoIndex) {
      proposal.place = (mesh.points[proposal.moved] + mesh.points[proposal.removed]) / 2;
      proposal.place_nearest = mesh.nearest[proposal.moved];
    }
    if (certify_ring(reference, mesh, proposal, 0.3, forward, scratch) != Answer::kProved) continue;
    ++proved;
    for (const RingScratch::Visit& visit : scratch.visits) {
      EXPECT_TRUE(proposal.before.contains(visit.triangle)) << "at triangle " << t;
    }
    for (const Index s : proposal.before) {
      ReverseProof proof;
      ++inside;
      covered += is_covered_by_ring(proposal, scratch, s, proof) ? 1 : 0;
    }
  }
  EXPECT_GT(proved, 100);
  EXPECT_GT(covered, 0.8 * inside);
}

TEST(ReverseCertificate, NeverAcceptsWhatSamplesRefute) {
  const Reference reference(shapes::ellipsoid());
  CertifiedMesh mesh = make_certified_mesh(reference);
  ReverseProofs proofs = make_reverse_proofs(reference.triangles.size());
  ReverseScratch scratch;
  RingScratch ring;
  ForwardScratch forward;
  int covered = 0;
  Proposal proposal;
  Random random(8, 0);
  const double tolerance = 0.25;
  int accepted = 0, refused = 0;
  for (int trial = 0; trial < 3000 && accepted < 500; ++trial) {
    const Index t = random.below(static_cast<std::uint32_t>(mesh.triangles.size()));
    if (!mesh.triangles[t].is_alive() || !propose_removal(mesh, t, random.below(3), proposal)) continue;
    proposal.place =
        (mesh.points[proposal.moved] + mesh.points[proposal.removed]) / 2 + random_vector(random, 0.2);
    proposal.place_nearest = mesh.nearest[proposal.moved];
    // Every other one with the help of the overlay, so that its proofs are among those checked.
    const bool has_ring = trial % 2 == 0 && certify_ring(reference, mesh, proposal, tolerance, forward,
                                                         ring) == Answer::kProved;
    if (!certify_reverse(reference, mesh, proofs, proposal, around(mesh, proposal),
                         has_ring ? &ring : nullptr, tolerance, scratch)) {
      ++refused;
      continue;
    }
    ++accepted;
    for (const Index s : scratch.renewed) {
      ReverseProof proof;
      covered += has_ring && is_covered_by_ring(proposal, ring, s, proof) ? 1 : 0;
    }
    for (std::size_t i = 0; accepted % 5 == 0 && i < scratch.renewed.size(); ++i) {
      const auto c = reference.corners(scratch.renewed[i]);
      for (const Vec3& p : {c[0], c[1], c[2], (c[0] + c[1] + c[2]) / 3, (c[0] + c[1]) / 2}) {
        EXPECT_LE(distance_to_mesh(mesh, proposal, p), tolerance * (1 + 1e-9));
      }
    }
    apply(proposal, mesh);
    commit_reverse(proposal, scratch, proofs);
  }
  EXPECT_GT(accepted, 100);
  EXPECT_GT(refused, 100);
  EXPECT_GT(covered, 100);
  // The invariant R: every isosurface triangle lies by its home and labels, and is listed there.
  std::vector<int> listed(reference.triangles.size(), 0);
  for (Index t = 0; t < mesh.triangles.size(); ++t) {
    proofs.for_homed(t, [&](Index s) {
      EXPECT_EQ(proofs.proof[s].home, t);
      EXPECT_TRUE(mesh.triangles[t].is_alive());
      ++listed[s];
    });
  }
  EXPECT_EQ(std::count(listed.begin(), listed.end(), 1), std::ptrdiff_t(listed.size()));
  for (Index s = 0; s < reference.triangles.size(); ++s) {
    const auto& proof = proofs.proof[s];
    const auto c = reference.corners(s);
    for (const Vec3& p : {c[0], c[1], c[2], (c[0] + c[1] + c[2]) / 3}) {
      double best = 1e300;
      for (const Index t : {proof.home, proof.label[0], proof.label[1], proof.label[2]}) {
        if (t == kNoIndex) continue;
        const auto& ids = mesh.triangles[t].corner;
        best = std::min(best,
                        squared_distance(p, {mesh.points[ids[0]], mesh.points[ids[1]], mesh.points[ids[2]]}));
      }
      EXPECT_LE(std::sqrt(best), tolerance * (1 + 1e-9));
    }
  }
}

}  // namespace
}  // namespace periost
