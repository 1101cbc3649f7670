// Our element metrics beside VTK's (Verdict) on random elements of every shape.
#include <gtest/gtest.h>
#include <vtkMeshQuality.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkTetra.h>
#include <vtkTriangle.h>

#include <array>
#include <cmath>
#include <random>

#include "pipeline/geometry/tet_quality.h"
#include "pipeline/geometry/triangle_quality.h"
#include "stages/marching_cubes/marching_cubes.h"
#include "stages/phantom/phantom.h"
#include "tests/support/tet_meshes.h"

namespace periost {
namespace {

constexpr int kElements = 2000;

// Flattened by up to a factor of a thousand, so that bad shapes occur, and away from the origin.
Vec3 random_point(std::mt19937& engine, double flatness) {
  std::uniform_real_distribution<double> unit(-1, 1);
  const double x = unit(engine), y = unit(engine), z = unit(engine);
  return {100 + 3 * x, -40 + 3 * y, 900 + 3 * flatness * z};
}

template <class Cell>
void place(Cell* cell, const Vec3* points, int count) {
  for (int k = 0; k < count; ++k) {
    cell->GetPoints()->SetPoint(k, points[k].x, points[k].y, points[k].z);
    cell->GetPointIds()->SetId(k, k);
  }
}

void expect_relative(double ours, double theirs, const char* what) {
  EXPECT_NEAR(ours, theirs, 1e-9 * std::max(1.0, std::abs(theirs))) << what;
}

// Every metric of triangles that both have.
class Triangles {
 public:
  Triangles() {
    cell_->GetPoints()->SetDataTypeToDouble();
    cell_->GetPoints()->SetNumberOfPoints(3);
  }
  void compare(const std::array<Vec3, 3>& p) {
    place(cell_.Get(), p.data(), 3);
    expect_relative(triangle_radius_ratio(p[0], p[1], p[2]), vtkMeshQuality::TriangleRadiusRatio(cell_),
                    "radius ratio");
    expect_relative(triangle_min_angle_deg(p[0], p[1], p[2]), vtkMeshQuality::TriangleMinAngle(cell_),
                    "smallest angle");
  }

 private:
  vtkNew<vtkTriangle> cell_;
};

// Every metric of tetrahedra that both have; VTK's MinAngle is none of dihedral angles.
class Tetrahedra {
 public:
  Tetrahedra() {
    cell_->GetPoints()->SetDataTypeToDouble();
    cell_->GetPoints()->SetNumberOfPoints(4);
  }
  void compare(const TetCorners& t) {
    place(cell_.Get(), t.data(), 4);
    expect_relative(tet_volume(t), vtkMeshQuality::TetVolume(cell_), "volume");
    expect_relative(tet_scaled_jacobian(t), vtkMeshQuality::TetScaledJacobian(cell_), "scaled Jacobian");
    expect_relative(tet_mean_ratio(t), vtkMeshQuality::TetShape(cell_), "mean ratio");
    expect_relative(tet_radius_ratio(t), vtkMeshQuality::TetRadiusRatio(cell_), "radius ratio");
    expect_relative(tet_aspect_ratio(t), vtkMeshQuality::TetAspectRatio(cell_), "aspect ratio");
  }

 private:
  vtkNew<vtkTetra> cell_;
};

TEST(Verdict, TrianglesAgree) {
  std::mt19937 engine(7);
  Triangles triangles;
  for (int i = 0; i < kElements; ++i) {
    triangles.compare({random_point(engine, 1), random_point(engine, 1), random_point(engine, 1)});
  }
}

// The isosurface of a bone, with the slivers that marching cubes leaves.
TEST(Verdict, TrianglesOfAnIsosurfaceAgree) {
  const Image image = make_phantom({.shape = PhantomShape::kFemur, .size = {{40, 32, 90}}}, {});
  const SurfaceMesh surface = marching_cubes(image, {.lower = 226}, {}, {}).surface;
  ASSERT_GT(surface.triangles.size(), 5000U);
  Triangles triangles;
  for (const auto& [a, b, c] : surface.triangles) {
    triangles.compare({surface.points[a], surface.points[b], surface.points[c]});
  }
}

TEST(Verdict, TetrahedraAgree) {
  std::mt19937 engine(11);
  Tetrahedra tetrahedra;
  for (int i = 0; i < kElements; ++i) {
    const double flatness = std::pow(10.0, -3.0 * i / kElements);
    TetCorners t;
    for (Vec3& corner : t) corner = random_point(engine, flatness);
    if (tet_volume(t) < 0) std::swap(t[0], t[1]);
    tetrahedra.compare(t);
  }
}

TEST(Verdict, TetrahedraOfAMeshAgree) {
  const TetMesh mesh = test::badly_shaped_box(1);
  Tetrahedra tetrahedra;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) tetrahedra.compare(tet_corners(mesh, t));
}

}  // namespace
}  // namespace periost
