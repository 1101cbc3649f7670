// Our element metrics beside VTK's (Verdict) on random elements of every shape.
#include <gtest/gtest.h>
#include <vtkMeshQuality.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkTetra.h>
#include <vtkTriangle.h>

#include <cmath>
#include <random>

#include "pipeline/geometry/tet_quality.h"
#include "pipeline/geometry/triangle_quality.h"

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
  EXPECT_NEAR(ours, theirs, 1e-6 * std::max(1.0, std::abs(theirs))) << what;
}

TEST(Verdict, TrianglesAgree) {
  std::mt19937 engine(7);
  vtkNew<vtkTriangle> cell;
  cell->GetPoints()->SetDataTypeToDouble();
  cell->GetPoints()->SetNumberOfPoints(3);
  for (int i = 0; i < kElements; ++i) {
    const Vec3 p[3] = {random_point(engine, 1), random_point(engine, 1), random_point(engine, 1)};
    place(cell.Get(), p, 3);
    expect_relative(triangle_radius_ratio(p[0], p[1], p[2]), vtkMeshQuality::TriangleRadiusRatio(cell),
                    "radius ratio");
    expect_relative(triangle_min_angle_deg(p[0], p[1], p[2]), vtkMeshQuality::TriangleMinAngle(cell),
                    "smallest angle");
  }
}

TEST(Verdict, TetrahedraAgree) {
  std::mt19937 engine(11);
  vtkNew<vtkTetra> cell;
  cell->GetPoints()->SetDataTypeToDouble();
  cell->GetPoints()->SetNumberOfPoints(4);
  for (int i = 0; i < kElements; ++i) {
    const double flatness = std::pow(10.0, -3.0 * i / kElements);
    TetCorners t;
    for (Vec3& corner : t) corner = random_point(engine, flatness);
    if (tet_volume(t) < 0) std::swap(t[0], t[1]);
    place(cell.Get(), t.data(), 4);
    expect_relative(tet_scaled_jacobian(t), vtkMeshQuality::TetScaledJacobian(cell), "scaled Jacobian");
    expect_relative(tet_mean_ratio(t), vtkMeshQuality::TetShape(cell), "mean ratio");
    expect_relative(tet_radius_ratio(t), vtkMeshQuality::TetRadiusRatio(cell), "radius ratio");
    expect_relative(tet_aspect_ratio(t), vtkMeshQuality::TetAspectRatio(cell), "aspect ratio");
  }
}

}  // namespace
}  // namespace periost
