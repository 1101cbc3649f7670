#include "pipeline/io/quality_json.h"

#include <nlohmann/json.hpp>

#include "pipeline/base/file.h"

namespace periost {
namespace {

using Json = nlohmann::ordered_json;

template <class T>
void set_if(Json& json, const char* key, const std::optional<T>& value) {
  if (value) json[key] = *value;
}

Json json_of(const Distribution& d) {
  return {{"count", d.count}, {"min", d.min}, {"p01", d.p01}, {"p05", d.p05},  {"p50", d.p50},
          {"p95", d.p95},     {"p99", d.p99}, {"max", d.max}, {"mean", d.mean}};
}

Json json_of(const DistanceSummary& d) {
  return {{"max", d.max}, {"mean", d.mean}, {"rms", d.rms}, {"p99", d.p99}};
}

Json json_of(const IsosurfaceQuality& q) {
  Json json{{"triangles", q.triangles}, {"vertices", q.vertices}, {"components", q.components},
            {"euler", q.euler},         {"closed", q.closed},     {"manifold", q.manifold}};
  if (q.voxel_mm > 0) json["voxel_mm"] = q.voxel_mm;
  if (q.closed) json["volume_mm3"] = q.volume_mm3;
  return json;
}

Json json_of(const DecimationReport& r) {
  return {{"triangles_before", r.triangles_before},
          {"triangles_after", r.triangles_after},
          {"rate", r.rate()},
          {"removals", r.removals},
          {"insertions", r.insertions},
          {"swaps", r.swaps},
          {"relocations", r.relocations},
          {"pieces", r.pieces},
          {"rejected",
           {{"link", r.rejected_link},
            {"topology", r.rejected_topology},
            {"barycentric", r.rejected_barycentric},
            {"angle", r.rejected_angle},
            {"fold", r.rejected_fold},
            {"distance", r.rejected_distance},
            {"reverse", r.rejected_reverse},
            {"self_intersection", r.rejected_self_intersection}}}};
}

Json json_of(const SurfaceDistance& d) {
  Json json{{"unit", d.unit},
            {"surface_to_isosurface", json_of(d.surface_to_isosurface)},
            {"isosurface_to_surface", json_of(d.isosurface_to_surface)},
            {"hausdorff", d.hausdorff}};
  set_if(json, "requested", d.requested);
  set_if(json, "over_requested", d.over_requested);
  return json;
}

Json json_of(const SurfaceQuality& q) {
  Json json{{"triangles", q.triangles}, {"vertices", q.vertices}, {"components", q.components},
            {"euler", q.euler},         {"closed", q.closed},     {"manifold", q.manifold},
            {"oriented", q.oriented}};
  set_if(json, "same_topology", q.same_topology);
  json["self_intersections"] = q.self_intersections;
  json["area_mm2"] = q.area_mm2;
  set_if(json, "volume_mm3", q.volume_mm3);
  if (q.min_angle_deg.count > 0) {
    json["min_angle_deg"] = json_of(q.min_angle_deg);
    json["share_below_20deg"] = q.share_below_20deg;
    json["share_below_30deg"] = q.share_below_30deg;
    json["radius_ratio"] = json_of(q.radius_ratio);
    json["valence_5_to_7"] = q.valence_5_to_7;
  }
  if (q.distance) json["distance"] = json_of(*q.distance);
  Json smoothness;
  set_if(smoothness, "simplex_angle_rms_deg", q.simplex_angle_rms_deg);
  set_if(smoothness, "normal_deviation_rms_deg", q.normal_deviation_rms_deg);
  if (!smoothness.empty()) json["smoothness"] = smoothness;
  set_if(json, "volume_change", q.volume_change);
  return json;
}

Json json_of(const VolumeQuality& q) {
  Json json{{"tets", q.tets},
            {"points", q.points},
            {"order", q.order},
            {"inverted", q.inverted},
            {"volume_mm3", q.volume_mm3}};
  const std::pair<const char*, const Distribution*> rows[] = {{"min_dihedral_deg", &q.min_dihedral_deg},
                                                              {"max_dihedral_deg", &q.max_dihedral_deg},
                                                              {"radius_ratio", &q.radius_ratio},
                                                              {"scaled_jacobian", &q.scaled_jacobian},
                                                              {"mean_ratio", &q.mean_ratio},
                                                              {"aspect_ratio", &q.aspect_ratio},
                                                              {"size_ratio", &q.size_ratio}};
  for (const auto& [name, distribution] : rows) {
    if (distribution->count > 0) json[name] = json_of(*distribution);
  }
  if (q.jacobian_ratio) json["jacobian_ratio"] = json_of(*q.jacobian_ratio);
  set_if(json, "boundary_preserved", q.boundary_preserved);
  return json;
}

Json json_of(const StretchQuality& q) {
  return {{"stiffness_n_per_mm", q.stiffness_n_per_mm},
          {"energy_n_mm", q.energy_n_mm},
          {"p95_von_mises_mpa", q.p95_von_mises_mpa},
          {"tets", q.tets},
          {"nodes", q.nodes},
          {"cg_iterations", q.cg_iterations}};
}

Json json_of(const MechanicsQuality& q) {
  Json json{{"patch_test_error", q.patch_test_error}, {"rigid_modes", q.rigid_modes},
            {"rigid_mode_error", q.rigid_mode_error}, {"condition_ratio", q.condition_ratio},
            {"cg_iterations", q.cg_iterations},       {"cg_ratio", q.cg_ratio}};
  if (q.reference) {
    const ReferenceQuality& r = *q.reference;
    json["reference"] = {{"stiffness", r.stiffness}, {"energy", r.energy}, {"p95_von_mises", r.p95_von_mises},
                         {"order", r.order},         {"axis", r.axis},     {"mesh", json_of(r.mesh)},
                         {"fine", json_of(r.fine)}};
  }
  return json;
}

Json json_of(const GateResult& gate) {
  Json json{{"metric", gate.metric}, {"op", gate.op}};
  set_if(json, "limit", gate.limit);
  set_if(json, "warn", gate.warn);
  json["value"] = gate.value;
  json["status"] = name_of(gate.status);
  json["worst"] = Json::array();
  for (const WorstElement& element : gate.worst) {
    Json worst{{"element", element.element},
               {"value", element.value},
               {"centre_mm", {element.centre_mm.x, element.centre_mm.y, element.centre_mm.z}}};
    if (!element.origin.empty()) worst["origin"] = element.origin;
    json["worst"].push_back(worst);
  }
  return json;
}

Json json_of(const RoundNote& note) {
  Json json{{"round", note.round}, {"verdict", name_of(note.verdict)}, {"changed", Json::object()}};
  for (const RoundChange& change : note.changed) json["changed"][change.key] = change.text;
  json["reason"] = note.reason;
  return json;
}

Json json_of(const Hint& hint) {
  Json json{{"round", hint.round}, {"stage", hint.stage}, {"parameter", hint.parameter}};
  if (hint.balls.empty()) json["factor"] = hint.factor;
  json["metric"] = hint.metric;
  json["value"] = hint.value;
  json["limit"] = hint.limit;
  json["reason"] = hint.reason;
  for (const HintBall& ball : hint.balls) {
    json["balls"].push_back({{"centre_mm", {ball.centre_mm.x, ball.centre_mm.y, ball.centre_mm.z}},
                             {"radius_mm", ball.radius_mm},
                             {"size_mm", ball.size_mm}});
  }
  return json;
}

void write_text(const std::string& text, const std::filesystem::path& path) {
  AtomicFile file(path);
  file.write(text);
  file.commit();
}

}  // namespace

std::string name_of(Verdict verdict) {
  return verdict == Verdict::kPass ? "pass" : verdict == Verdict::kWarn ? "warn" : "fail";
}

std::string quality_json(const QualityReport& report) {
  Json json{{"schema", "periost-quality/1"}, {"verdict", name_of(report.verdict)}};
  if (!report.preset.empty()) json["preset"] = report.preset;
  if (report.isosurface) json["isosurface"] = json_of(*report.isosurface);
  if (report.decimation) json["decimation"] = json_of(*report.decimation);
  if (report.surface) json["surface"] = json_of(*report.surface);
  if (report.volume) json["volume"] = json_of(*report.volume);
  if (report.mechanics) json["mechanics"] = json_of(*report.mechanics);
  json["gates"] = Json::array();
  for (const GateResult& gate : report.gates) json["gates"].push_back(json_of(gate));
  for (const RoundNote& note : report.rounds) json["rounds"].push_back(json_of(note));
  return json.dump(1) + "\n";
}

void write_quality_json(const QualityReport& report, const std::filesystem::path& path) {
  write_text(quality_json(report), path);
}

std::string hints_json(const Hints& hints) {
  Json json{{"schema", "periost-hints/1"}, {"hints", Json::array()}, {"rounds", Json::array()}};
  for (const Hint& hint : hints.hints) json["hints"].push_back(json_of(hint));
  for (const RoundNote& note : hints.rounds) json["rounds"].push_back(json_of(note));
  return json.dump(1) + "\n";
}

void write_hints_json(const Hints& hints, const std::filesystem::path& path) {
  write_text(hints_json(hints), path);
}

}  // namespace periost
