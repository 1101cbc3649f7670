#include <gtest/gtest.h>

#include <algorithm>

#include "pipeline/geometry/isosurface_query.h"
#include "pipeline/geometry/simplex_dual.h"
#include "stages/decimate/criteria.h"
#include "stages/decimate/law_of_motion.h"
#include "tests/unit/stages/decimate/phantoms.h"

namespace periost {
namespace {

std::vector<SimplexVertex> all_vertices(const SimplexMesh& mesh) {
  std::vector<SimplexVertex> vertices(mesh.face.size());
  for (std::uint32_t v = 0; v < vertices.size(); ++v) vertices[v] = SimplexVertex{v};
  return vertices;
}

double rms_height(const SimplexMesh& mesh) {
  double sum = 0;
  for (const SimplexVertex v : all_vertices(mesh)) {
    const double h = simplex_parameters(mesh, v).height;
    sum += h * h;
  }
  return std::sqrt(sum / static_cast<double>(mesh.face.size()));
}

TEST(LawOfMotion, NeighbourhoodsGrowByOneRing) {
  const Isosurface ball = test::binary_ball(8);
  const SimplexMesh mesh = dual_simplex_mesh(ball.surface);
  MotionMarks marks(mesh.face.size());
  std::vector<SimplexVertex> q;
  const SimplexVertex seed{100};
  gather_neighbourhood(mesh, {seed}, 0, marks, q);
  EXPECT_EQ(q, std::vector<SimplexVertex>{seed});
  gather_neighbourhood(mesh, {seed}, 1, marks, q);
  ASSERT_EQ(q.size(), 4u);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(q[k + 1], mesh.neighbour[100][k]);
  gather_neighbourhood(mesh, {seed}, 4, marks, q);
  EXPECT_GT(q.size(), 15u);
  EXPECT_LE(q.size(), 46u);
  auto unique = q;
  std::sort(unique.begin(), unique.end());
  EXPECT_EQ(std::unique(unique.begin(), unique.end()), unique.end());
  EXPECT_TRUE(std::all_of(marks.local.begin(), marks.local.end(), [](auto m) { return m == kNoIndex; }));
}

TEST(LawOfMotion, SmoothsTheStepsOfABinaryBallAndStaysNear) {
  const Isosurface ball = test::binary_ball(8);
  const SimplexMesh original = dual_simplex_mesh(ball.surface);
  MotionMarks marks(original.face.size());
  double softer = rms_height(original);
  for (const double stiffness : {0.5, 0.15, 0.02}) {
    SimplexMesh mesh = original;
    LawOfMotion law(ball, {.rigidity = 2, .stiffness = stiffness, .iterations = 20, .reach_mm = 3}, marks);
    law.select(mesh, all_vertices(mesh));
    law.deform(mesh);
    EXPECT_LT(rms_height(mesh), softer) << "less stiffness, smoother";
    softer = rms_height(mesh);
    for (const Vec3 p : mesh.position) EXPECT_TRUE(closest_point(ball, p, 1.0)) << stiffness;
  }
}

// Root mean square sine between the model's normals and those of the ball behind the steps.
double normal_deviation(const Isosurface& ball, const SimplexMesh& mesh) {
  const auto& dims = ball.frame.dims;
  const Vec3 centre = ball.frame.to_lps(0.5 * Vec3{dims[0] - 1.0, dims[1] - 1.0, dims[2] - 1.0});
  double sum = 0;
  for (const SimplexVertex v : all_vertices(mesh)) {
    sum += squared_norm(cross(simplex_parameters(mesh, v).normal, normalized(position_of(mesh, v) - centre)));
  }
  return std::sqrt(sum / static_cast<double>(mesh.face.size()));
}

TEST(LawOfMotion, RigidityBuysSmoothness) {
  const Isosurface ball = test::binary_ball(12);
  const SimplexMesh original = dual_simplex_mesh(ball.surface);
  MotionMarks marks(original.face.size());
  double rougher = 1;
  for (const int rigidity : {0, 1, 3}) {
    SimplexMesh mesh = original;
    LawOfMotion law(ball, {.rigidity = rigidity, .stiffness = 0.15, .iterations = 20, .reach_mm = 3}, marks);
    law.select(mesh, all_vertices(mesh));
    law.deform(mesh);
    const double roughness = normal_deviation(ball, mesh);
    EXPECT_LT(roughness, 0.95 * rougher) << "rigidity " << rigidity;
    rougher = roughness;
  }
}

TEST(LawOfMotion, MovesOnlyWhatIsSelected) {
  const Isosurface ball = test::binary_ball(8);
  const SimplexMesh original = dual_simplex_mesh(ball.surface);
  SimplexMesh mesh = original;
  MotionMarks marks(mesh.face.size());
  LawOfMotion law(ball, {.rigidity = 1, .reach_mm = 3}, marks);
  const std::vector<SimplexVertex> moved = law.select(mesh, {SimplexVertex{30}, SimplexVertex{700}});
  EXPECT_EQ(moved.size(), 8u);
  law.deform(mesh);
  for (const SimplexVertex v : all_vertices(mesh)) {
    const bool is_selected = std::find(moved.begin(), moved.end(), v) != moved.end();
    EXPECT_TRUE(is_selected || position_of(mesh, v) == position_of(original, v));
  }
  EXPECT_NE(mesh.position[30], original.position[30]);
}

TEST(LawOfMotion, TheExternalForcePullsAVertexBack) {
  const Isosurface ball = test::binary_ball(8);
  SimplexMesh mesh = dual_simplex_mesh(ball.surface);
  MotionMarks marks(mesh.face.size());
  const SimplexVertex v{500};
  const Vec3 away = 0.8 * simplex_parameters(mesh, v).normal;
  mesh.position[500] += away;
  const double before = closest_point(ball, mesh.position[500], 3)->distance;
  LawOfMotion law(ball, {.rigidity = 0, .stiffness = 0.5, .reach_mm = 3}, marks);
  law.select(mesh, {v});
  law.deform(mesh);
  EXPECT_LT(closest_point(ball, mesh.position[500], 3)->distance, 0.3 * before);
}

TEST(Criteria, DeficitsAreZeroExactlyWhereTheCriterionHolds) {
  const Isosurface ball = test::binary_ball(8);
  SimplexMesh mesh = dual_simplex_mesh(ball.surface);
  for (const SimplexVertex v : all_vertices(mesh)) {
    const auto e = simplex_parameters(mesh, v).barycentric;
    EXPECT_EQ(barycentric_deficit(mesh, v, 0.1) == 0, *std::min_element(e.begin(), e.end()) >= 0.1);
  }
  const Vec3 normal = simplex_parameters(mesh, SimplexVertex{500}).normal;
  const Vec3 on = mesh.position[500];
  EXPECT_EQ(distance_deficit(ball, on + 0.2 * normal, normal, 0.3), 0);
  EXPECT_GT(distance_deficit(ball, on + 0.9 * normal, normal, 0.3), 0);
  EXPECT_EQ(distance_deficit(ball, on + 5.0 * normal, normal, 0.3), 0.6) << "capped";
  EXPECT_EQ(distance_deficit(ball, on + 0.05 * normal, -normal, 0.3), 0.6)
      << "the sheet must face the same way";
}

}  // namespace
}  // namespace periost
