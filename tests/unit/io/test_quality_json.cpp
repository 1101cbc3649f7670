#include "pipeline/io/quality_json.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "pipeline/geometry/gates.h"
#include "tests/support/surfaces.h"

namespace periost {
namespace {

using Json = nlohmann::json;

// A report with a different value in every place.
QualityReport full_report() {
  QualityReport report;
  double next = 0.125;
  const auto fill = [&](Distribution& d) {
    d.count = 3;
    for (double* value : {&d.min, &d.p01, &d.p05, &d.p50, &d.p95, &d.p99, &d.max, &d.mean})
      *value = next += 0.1;
  };
  const auto fill_distance = [&](DistanceSummary& d) {
    for (double* value : {&d.max, &d.mean, &d.rms, &d.p99}) *value = next += 0.1;
  };
  report.isosurface = IsosurfaceQuality{100, 52, 1, 2, true, true, 1.5, 33.25};
  report.decimation.emplace();
  report.decimation->triangles_before = 100;
  report.decimation->triangles_after = 10;
  SurfaceQuality& s = report.surface.emplace();
  s.triangles = 10;
  s.vertices = 7;
  s.components = 3;
  s.euler = -4;
  s.closed = true;
  s.self_intersections = 5;
  s.area_mm2 = next += 0.1;
  s.volume_mm3 = next += 0.1;
  fill(s.min_angle_deg);
  fill(s.radius_ratio);
  s.share_below_20deg = next += 0.1;
  s.share_below_30deg = next += 0.1;
  s.valence_5_to_7 = next += 0.1;
  SurfaceDistance& d = s.distance.emplace();
  d.unit = "voxel";
  fill_distance(d.surface_to_isosurface);
  fill_distance(d.isosurface_to_surface);
  d.hausdorff = next += 0.1;
  d.requested = next += 0.1;
  d.over_requested = next += 0.1;
  s.simplex_angle_rms_deg = next += 0.1;
  s.normal_deviation_rms_deg = next += 0.1;
  s.volume_change = -1.0 / 3;
  s.same_topology = false;
  VolumeQuality& v = report.volume.emplace();
  v.tets = 11;
  v.points = 12;
  v.order = 2;
  v.inverted = 13;
  v.volume_mm3 = next += 0.1;
  for (Distribution* distribution :
       {&v.min_dihedral_deg, &v.max_dihedral_deg, &v.radius_ratio, &v.scaled_jacobian, &v.mean_ratio,
        &v.aspect_ratio, &v.size_ratio, &v.jacobian_ratio.emplace()}) {
    fill(*distribution);
  }
  v.boundary_preserved = true;
  MechanicsQuality& m = report.mechanics.emplace();
  m.patch_test_error = 1e-12 / 3;
  m.rigid_modes = 14;
  m.rigid_mode_error = next += 0.1;
  m.condition_ratio = next += 0.1;
  m.cg_iterations = 15;
  m.cg_ratio = next += 0.1;
  m.reference = ReferenceQuality{-1.0 / 7, 1.0 / 9, -1.0 / 11, 1, "z", {1.5, 2.5, 3.5, 16, 17, 18}, {}};
  return report;
}

// What stands under a metric's path: names joined by dots.
const Json* at_path(const Json& json, const std::string& path) {
  const Json* node = &json;
  for (std::size_t begin = 0; begin <= path.size();) {
    const std::size_t end = std::min(path.find('.', begin), path.size());
    const auto found = node->find(path.substr(begin, end - begin));
    if (found == node->end()) return nullptr;
    node = &*found;
    begin = end + 1;
  }
  return node;
}

TEST(QualityJson, EveryMetricStandsUnderItsPathToTheLastBit) {
  const QualityReport report = full_report();
  const Json json = Json::parse(quality_json(report));
  EXPECT_EQ(json["schema"], "periost-quality/1");
  EXPECT_EQ(json["verdict"], "pass");
  for (const Metric& metric : metrics()) {
    const Json* node = at_path(json, metric.path);
    ASSERT_NE(node, nullptr) << metric.path;
    const double value = node->is_boolean() ? (node->get<bool>() ? 1 : 0) : node->get<double>();
    EXPECT_EQ(value, metric.value(report)) << metric.path;
  }
  EXPECT_EQ(quality_json(report), quality_json(full_report()));
}

TEST(QualityJson, WhatWasNotMeasuredIsAbsent) {
  const Json empty = Json::parse(quality_json(QualityReport{}));
  for (const char* key : {"isosurface", "decimation", "surface", "volume", "preset", "mechanics"}) {
    EXPECT_FALSE(empty.contains(key)) << key;
  }
  QualityReport report = full_report();
  report.surface->distance.reset();
  report.surface->volume_change.reset();
  report.volume->jacobian_ratio.reset();
  const Json json = Json::parse(quality_json(report));
  EXPECT_FALSE(json["surface"].contains("distance"));
  EXPECT_FALSE(json["surface"].contains("volume_change"));
  EXPECT_FALSE(json["volume"].contains("jacobian_ratio"));
}

TEST(QualityJson, GatesCarryTheirWorstElements) {
  QualityReport report = full_report();
  WorstElements worst;
  worst["surface.min_angle_deg"] = {{17, 0.225, {1, 2, 3}, "somewhere"}};
  apply_gates(report, worst, Preset::kFeStandard, {});
  const Json json = Json::parse(quality_json(report));
  EXPECT_EQ(json["verdict"], "fail");
  EXPECT_EQ(json["preset"], "fe-standard");
  bool found = false;
  for (const Json& gate : json["gates"]) {
    if (gate["metric"] != "surface.min_angle_deg.min") continue;
    found = true;
    EXPECT_EQ(gate["op"], ">=");
    EXPECT_EQ(gate["limit"], 5);
    EXPECT_EQ(gate["warn"], 15);
    EXPECT_EQ(gate["status"], "fail");
    EXPECT_EQ(gate["worst"][0]["element"], 17);
    EXPECT_EQ(gate["worst"][0]["centre_mm"], Json({1.0, 2.0, 3.0}));
    EXPECT_EQ(gate["worst"][0]["origin"], "somewhere");
  }
  EXPECT_TRUE(found);
}

}  // namespace
}  // namespace periost
