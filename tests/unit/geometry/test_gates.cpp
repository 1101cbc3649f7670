#include "pipeline/geometry/gates.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "pipeline/geometry/measure_surface.h"
#include "pipeline/geometry/measure_volume.h"
#include "tests/support/rigid_motion.h"
#include "tests/support/surfaces.h"

namespace periost {
namespace {

// A box of n^3 cubes, five tetrahedra each, mirrored in every second one so that faces match.
TetMesh box_of_tets(Index n, double side) {
  TetMesh mesh;
  const auto id = [&](Index i, Index j, Index k) { return (k * (n + 1) + j) * (n + 1) + i; };
  for (Index k = 0; k <= n; ++k) {
    for (Index j = 0; j <= n; ++j) {
      for (Index i = 0; i <= n; ++i) mesh.points.push_back({i * side, j * side, k * side});
    }
  }
  const int even[5][4] = {{0, 1, 2, 4}, {3, 2, 1, 7}, {5, 4, 7, 1}, {6, 7, 4, 2}, {1, 2, 4, 7}};
  for (Index k = 0; k < n; ++k) {
    for (Index j = 0; j < n; ++j) {
      for (Index i = 0; i < n; ++i) {
        const bool mirrored = (i + j + k) % 2 == 1;
        for (const auto& tet : even) {
          Tetrahedron t;
          for (std::size_t c = 0; c < 4; ++c) {
            const int corner = mirrored ? tet[c] ^ 1 : tet[c];
            t[c] = id(i + (corner & 1), j + (corner >> 1 & 1), k + (corner >> 2 & 1));
          }
          const Vec3 a = mesh.points[t[0]];
          if (dot(mesh.points[t[1]] - a, cross(mesh.points[t[2]] - a, mesh.points[t[3]] - a)) < 0) {
            std::swap(t[0], t[1]);
          }
          mesh.tets.push_back(t);
        }
      }
    }
  }
  mesh.region.assign(mesh.tets.size(), 1);
  return mesh;
}

Measurement measured_sphere(double radius_change, const Context& context = {}) {
  SurfaceMesh isosurface = test::sphere_surface({5, -6, 700}, 20, 4),
              surface = test::sphere_surface({5, -6, 700}, 20 + radius_change, 3);
  isosurface.voxel_mm = 1.5;
  DecimationReport decimation;
  decimation.triangles_before = 5120;
  decimation.triangles_after = 1280;
  decimation.requested_distance_mm = 0.45;
  return measure_quality({&isosurface, &decimation, &surface, nullptr, 0}, {}, context);
}

TEST(MeasureQuality, ASphereAgainstAFinerOne) {
  const QualityReport report = measured_sphere(0.15).report;
  ASSERT_TRUE(report.surface && report.isosurface && report.surface->distance);
  EXPECT_EQ(report.isosurface->triangles, 5120u);
  EXPECT_EQ(report.surface->euler, 2);
  EXPECT_EQ(report.surface->same_topology, true);
  EXPECT_EQ(report.surface->self_intersections, 0u);
  EXPECT_EQ(report.surface->distance->unit, "voxel");
  EXPECT_NEAR(report.surface->distance->surface_to_isosurface.max, 0.1, 0.03);
  EXPECT_NEAR(*report.surface->distance->requested, 0.3, 1e-12);
  EXPECT_EQ(*report.surface->distance->over_requested, 0);
  EXPECT_EQ(report.surface->valence_5_to_7, 1);
  EXPECT_GT(report.surface->min_angle_deg.min, 45);
  EXPECT_NEAR(report.decimation->rate(), 0.75, 1e-12);
  EXPECT_FALSE(report.volume.has_value());
}

TEST(MeasureQuality, SmoothnessTellsASmoothSphereFromARoughOne) {
  const SurfaceMesh smooth = test::sphere_surface({0, 0, 0}, 10, 4);
  SurfaceMesh rough = smooth;
  for (std::size_t p = 0; p < rough.points.size(); p += 3) rough.points[p] = rough.points[p] * 1.02;
  EXPECT_LT(*simplex_angle_rms_deg(smooth), 0.3 * *simplex_angle_rms_deg(rough));
  EXPECT_LT(normal_deviation_rms_deg(smooth), normal_deviation_rms_deg(rough));
  EXPECT_NEAR(normal_deviation_rms_deg(test::box_surface({0, 0, 0}, {1, 1, 1})), 90 * std::sqrt(12.0 / 18),
              1e-9);
  SurfaceMesh moved = rough;
  for (Vec3& p : moved.points) p = test::moved(p);
  EXPECT_NEAR(*simplex_angle_rms_deg(moved), *simplex_angle_rms_deg(rough), 1e-6);
}

TEST(MeasureQuality, VolumesSumToTheBoxAndItsBoundaryIsClosed) {
  const TetMesh mesh = box_of_tets(4, 0.5);
  WorstElements worst;
  const VolumeQuality quality = measure_volume(mesh, Context{}, worst);
  EXPECT_NEAR(quality.volume_mm3, 8, 1e-12);
  EXPECT_EQ(quality.inverted, 0u);
  EXPECT_NEAR(quality.max_dihedral_deg.max, 90, 1e-9);
  EXPECT_NEAR(quality.size_ratio.max, std::cbrt(2.0), 1e-12);
  EXPECT_EQ(quality.min_dihedral_deg.count, mesh.tets.size());
  const SurfaceMesh boundary = boundary_surface(mesh);
  EXPECT_EQ(boundary.triangles.size(), 6u * 16 * 2);
  SurfaceQuality surface = measure_surface(boundary, {}, Context{}, worst);
  EXPECT_TRUE(surface.closed && surface.manifold && surface.oriented);
  EXPECT_NEAR(*surface.volume_mm3, 8, 1e-12);
  EXPECT_EQ(surface.euler, 2);
  ASSERT_EQ(worst["volume.min_dihedral_deg"].size(), 10u);
  EXPECT_NE(worst["volume.min_dihedral_deg"][0].origin, "");
}

TEST(MeasureQuality, TheWorstTetrahedraOfThinWallsSayHowThinTheseAre) {
  for (const double height : {0.1, 2.0}) {
    TetMesh mesh = box_of_tets(2, 1);
    for (Vec3& p : mesh.points) p.z *= height;
    const SurfaceMesh isosurface = test::box_surface({0, 0, 0}, {2, 2, 2 * height});
    const Measurement measured =
        measure_quality({.isosurface = &isosurface, .tet_mesh = &mesh}, {}, Context{});
    const std::string origin = measured.worst.at("volume.min_dihedral_deg")[0].origin;
    EXPECT_EQ(origin.find("is 0.2 mm thick") != std::string::npos, height == 0.1) << origin;
  }
}

TEST(MeasureQuality, AnInvertedTetrahedronIsCountedAndNamed) {
  TetMesh mesh = box_of_tets(2, 1);
  std::swap(mesh.tets[17][0], mesh.tets[17][1]);
  WorstElements worst;
  const VolumeQuality quality = measure_volume(mesh, Context{}, worst);
  EXPECT_EQ(quality.inverted, 1u);
  ASSERT_EQ(worst["volume.inverted"].size(), 1u);
  EXPECT_EQ(worst["volume.inverted"][0].element, 17u);
  QualityReport report;
  report.volume = quality;
  apply_gates(report, worst, Preset::kLenient, {});
  EXPECT_EQ(report.verdict, Verdict::kFail);
}

TEST(MeasureQuality, ThreadsDoNotChangeABit) {
  Context three;
  three.threads = 3;
  const TetMesh mesh = box_of_tets(20, 0.3);
  WorstElements a, b;
  const VolumeQuality x = measure_volume(mesh, Context{}, a), y = measure_volume(mesh, three, b);
  EXPECT_EQ(x.mean_ratio.mean, y.mean_ratio.mean);
  EXPECT_EQ(x.size_ratio.mean, y.size_ratio.mean);
  const Measurement one = measured_sphere(0.1), two = measured_sphere(0.1, three);
  EXPECT_EQ(one.report.surface->distance->hausdorff, two.report.surface->distance->hausdorff);
  EXPECT_EQ(one.report.surface->distance->surface_to_isosurface.rms,
            two.report.surface->distance->surface_to_isosurface.rms);
}

TEST(Metrics, PathsAreUniqueDocumentedAndFound) {
  std::set<std::string> paths;
  for (const Metric& metric : metrics()) {
    EXPECT_TRUE(paths.insert(metric.path).second) << metric.path;
    EXPECT_FALSE(metric.doc.empty()) << metric.path;
    EXPECT_TRUE(metric.op == ">=" || metric.op == ">" || metric.op == "<=" || metric.op == "==")
        << metric.path;
    EXPECT_EQ(metric.value(QualityReport{}), std::nullopt) << metric.path;
  }
  EXPECT_EQ(find_metric("volume.min_dihedral.min"), nullptr);
  EXPECT_EQ(nearest_metric("volume.min_dihedral_dg.min"), "volume.min_dihedral_deg.min");
}

TEST(Presets, RowsNameMetricsAndGetStricter) {
  for (const PresetRow& row : preset_rows()) {
    const Metric* metric = find_metric(row.metric);
    ASSERT_NE(metric, nullptr) << row.metric;
    const auto is_at_least = [&](const GateLimits& strict, const GateLimits& loose) {
      if (!loose.limit) return true;
      if (!strict.limit) return false;
      if (metric->op == "<=") return *strict.limit <= *loose.limit;
      return *strict.limit >= *loose.limit;
    };
    EXPECT_TRUE(is_at_least(row.fe_standard, row.lenient)) << row.metric;
    EXPECT_TRUE(is_at_least(row.fe_strict, row.fe_standard)) << row.metric;
    const GateLimits& standard = row.fe_standard;
    if (standard.limit && standard.warn) {
      EXPECT_TRUE(metric->op == "<=" ? *standard.warn < *standard.limit : *standard.warn > *standard.limit)
          << row.metric << ": a warning comes before the failure";
    }
  }
}

TEST(Gates, PassWarnAndFail) {
  Measurement good = measured_sphere(0.05);
  apply_gates(good.report, good.worst, Preset::kFeStandard, {});
  EXPECT_NE(good.report.verdict, Verdict::kFail);
  EXPECT_EQ(good.report.preset, "fe-standard");
  EXPECT_FALSE(good.report.gates.empty());

  Measurement far = measured_sphere(2);
  apply_gates(far.report, far.worst, Preset::kFeStandard, {});
  EXPECT_EQ(far.report.verdict, Verdict::kFail);
  std::set<std::string> failed;
  for (const GateResult& gate : far.report.gates) {
    if (gate.status != Verdict::kFail) continue;
    failed.insert(gate.metric);
    if (gate.metric == "surface.distance.hausdorff") {
      ASSERT_EQ(gate.worst.size(), 10u);
      EXPECT_NEAR(gate.worst[0].value, gate.value, 1e-9);
      EXPECT_NE(describe(gate).find("surface.distance.hausdorff is 1.3"), std::string::npos)
          << describe(gate);
      EXPECT_NE(describe(gate).find(" mm, element "), std::string::npos);
    }
  }
  EXPECT_TRUE(failed.contains("surface.distance.hausdorff"));
  EXPECT_TRUE(failed.contains("surface.distance.over_requested"));
  EXPECT_TRUE(failed.contains("surface.volume_change"));

  Measurement shrunk = measured_sphere(-2);
  apply_gates(shrunk.report, shrunk.worst, Preset::kFeStandard,
              {{"surface.distance.hausdorff", {std::nullopt, 1}}});
  for (const GateResult& gate : shrunk.report.gates) {
    if (gate.metric == "surface.volume_change") {
      EXPECT_LT(gate.value, 0);
      EXPECT_EQ(gate.status, Verdict::kFail) << "a loss of volume counts like a gain";
    }
    if (gate.metric == "surface.distance.hausdorff") {
      EXPECT_EQ(gate.status, Verdict::kWarn);
    }
  }
}

TEST(Gates, OverridesReplaceRowsAndAddOthers) {
  Measurement m = measured_sphere(0.05);
  apply_gates(m.report, m.worst, Preset::kNone,
              {{"surface.triangles", {1000, std::nullopt}}, {"volume.tets", {10, std::nullopt}}});
  ASSERT_EQ(m.report.gates.size(), 1u) << "metrics that were not measured have no gate";
  EXPECT_EQ(m.report.gates[0].metric, "surface.triangles");
  EXPECT_EQ(m.report.gates[0].status, Verdict::kFail);
  EXPECT_EQ(m.report.preset, "");
  apply_gates(m.report, m.worst, Preset::kNone, {{"surface.triangles", {std::nullopt, 1000}}});
  EXPECT_EQ(m.report.verdict, Verdict::kWarn);
  apply_gates(m.report, m.worst, Preset::kNone, {});
  EXPECT_EQ(m.report.verdict, Verdict::kPass);
  EXPECT_TRUE(m.report.gates.empty());
}

TEST(Gates, RowsInVoxelsNeedVoxels) {
  const SurfaceMesh a = test::sphere_surface({}, 20, 3), b = test::sphere_surface({}, 25, 3);
  Measurement m = measure_quality({&a, nullptr, &b, nullptr, 0}, {}, Context{});
  EXPECT_EQ(m.report.surface->distance->unit, "mm");
  apply_gates(m.report, m.worst, Preset::kFeStrict, {});
  for (const GateResult& gate : m.report.gates) EXPECT_NE(gate.metric, "surface.distance.hausdorff");
  apply_gates(m.report, m.worst, Preset::kNone, {{"surface.distance.hausdorff", {4, std::nullopt}}});
  EXPECT_EQ(m.report.verdict, Verdict::kFail);
}

TEST(Gates, AnOpenSurfaceFailsWithItsPlaces) {
  SurfaceMesh open = test::sphere_surface({}, 20, 2);
  open.triangles.pop_back();
  Measurement m = measure_quality({nullptr, nullptr, &open, nullptr, 0}, {}, Context{});
  EXPECT_FALSE(m.report.surface->volume_mm3.has_value());
  apply_gates(m.report, m.worst, Preset::kLenient, {});
  ASSERT_FALSE(m.report.gates.empty());
  EXPECT_EQ(m.report.gates[0].metric, "surface.closed");
  EXPECT_EQ(m.report.gates[0].status, Verdict::kFail);
  EXPECT_EQ(m.report.gates[0].worst.size(), 3u);
}

}  // namespace
}  // namespace periost
