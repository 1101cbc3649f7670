#pragma once
// Measured quality and the verdict on it, as it goes to quality.json (schema periost-quality/1). An optional
// that is empty was not measured. Units: mm, degrees, fractions 0..1.
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/data/simplex_mesh.h"
#include "pipeline/data/vec.h"

namespace periost {

// Summary of one number per element. Percentiles interpolate linearly between order statistics.
struct Distribution {
  std::uint64_t count = 0;
  double min = 0, p01 = 0, p05 = 0, p50 = 0, p95 = 0, p99 = 0, max = 0, mean = 0;
};

struct IsosurfaceQuality {
  std::uint64_t triangles = 0, vertices = 0;
  std::uint32_t components = 0;
  std::int64_t euler = 0;
  bool closed = false, manifold = false;
  double voxel_mm = 0, volume_mm3 = 0;
};

// One direction of the distance between two surfaces, in the unit of SurfaceDistance.
struct DistanceSummary {
  double max = 0, mean = 0, rms = 0, p99 = 0;
};

struct SurfaceDistance {
  std::string unit;  // "voxel" or "mm"
  DistanceSummary surface_to_isosurface, isosurface_to_surface;
  double hausdorff = 0;
  std::optional<double> requested;       // what decimate was asked, same unit
  std::optional<double> over_requested;  // max(0, hausdorff / requested - 1)
};

struct SurfaceQuality {
  std::uint64_t triangles = 0, vertices = 0;
  std::uint32_t components = 0;
  std::int64_t euler = 0;
  bool closed = false, manifold = false, oriented = false;
  std::uint64_t self_intersections = 0;
  double area_mm2 = 0;
  std::optional<double> volume_mm3;  // closed surfaces only
  Distribution min_angle_deg;
  Distribution radius_ratio;
  double share_below_20deg = 0, share_below_30deg = 0, valence_5_to_7 = 0;
  std::optional<SurfaceDistance> distance;
  std::optional<double> simplex_angle_rms_deg, normal_deviation_rms_deg;
  std::optional<double> volume_change;  // (V - V_iso) / V_iso, signed
  std::optional<bool> same_topology;    // components and Euler number are the isosurface's
};

struct VolumeQuality {
  std::uint64_t tets = 0, points = 0;
  int order = 1;
  std::uint64_t inverted = 0;
  double volume_mm3 = 0;
  Distribution min_dihedral_deg, max_dihedral_deg, radius_ratio, scaled_jacobian, mean_ratio, aspect_ratio,
      size_ratio;
  std::optional<Distribution> jacobian_ratio;  // second order only
  std::optional<bool> boundary_preserved;
};

// How one mesh bears the load case of pipeline/mechanics/stretch.h.
struct StretchQuality {
  double stiffness_n_per_mm = 0, energy_n_mm = 0, p95_von_mises_mpa = 0;
  std::uint64_t tets = 0, nodes = 0, cg_iterations = 0;  // nodes: mid-side ones included
};

// The same load case on the mesh and on one of the undecimated surface.
struct ReferenceQuality {
  double stiffness = 0, energy = 0, p95_von_mises = 0;  // (mesh's - fine's) / fine's, signed
  int order = 2;     // of the elements of both; at 1 no gate judges the three above
  std::string axis;  // "x", "y" or "z" of LPS
  StretchQuality mesh, fine;
};

// The mesh as a solver meets it (pipeline/mechanics/fitness.h).
struct MechanicsQuality {
  double patch_test_error = 0;
  std::uint64_t rigid_modes = 0;  // less six for each further body
  double rigid_mode_error = 0;
  double condition_ratio = 0;
  std::uint64_t cg_iterations = 0;
  double cg_ratio = 0;
  std::optional<ReferenceQuality> reference;
};

enum class Verdict { kPass, kWarn, kFail };

struct WorstElement {
  std::uint64_t element = 0;
  double value = 0;
  Vec3 centre_mm;
  std::string origin;  // whose choice it goes back to, or empty
};

struct GateResult {
  std::string metric;  // path in quality.json
  std::string op;      // ">=", ">", "<=", "=="
  std::optional<double> limit, warn;
  double value = 0;
  Verdict status = Verdict::kPass;
  std::vector<WorstElement> worst;  // at most ten
};

// One key that a round's hints change for the next round.
struct RoundChange {
  std::string key;   // "decimate.refine"
  std::string text;  // "12 places"
  friend bool operator==(const RoundChange&, const RoundChange&) = default;
};

// How a round of feedback ended, and what it changes for the next one.
struct RoundNote {
  std::uint32_t round = 1;
  Verdict verdict = Verdict::kPass;
  std::vector<RoundChange> changed;
  std::string reason;  // one sentence or more; empty where nothing is changed
  friend bool operator==(const RoundNote&, const RoundNote&) = default;
};

struct QualityReport {
  Verdict verdict = Verdict::kPass;
  std::string preset;
  std::optional<IsosurfaceQuality> isosurface;
  std::optional<DecimationReport> decimation;
  std::optional<SurfaceQuality> surface;
  std::optional<VolumeQuality> volume;
  std::optional<MechanicsQuality> mechanics;
  std::vector<GateResult> gates;
  std::vector<RoundNote> rounds;  // up to the one that made the report
};

}  // namespace periost
