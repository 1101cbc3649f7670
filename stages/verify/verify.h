#pragma once
// Measures the chain's meshes and judges them by gates. A failed gate is a result, not an error: the report
// carries the verdict, and the runner decides what follows from it.
#include "pipeline/base/context.h"
#include "pipeline/base/quantity.h"
#include "pipeline/data/hints.h"
#include "pipeline/data/isosurface.h"
#include "pipeline/data/quality_report.h"
#include "pipeline/data/simplex_mesh.h"
#include "pipeline/data/surface_mesh.h"
#include "pipeline/data/tet_mesh.h"
#include "pipeline/geometry/gates.h"

namespace periost {

// Whether the mesh is looked at as a solver would (pipeline/mechanics/fitness.h).
enum class MechanicsCheck {
  kByPreset,  // what the preset's row in the table of verify.cpp says
  kNone,
  kBasic,      // patch test, motions without energy, conditioning
  kReference,  // these, and the same load on a mesh of the undecimated surface (reference.h)
};

struct VerifyOptions {
  Preset preset = Preset::kFeStandard;
  GateOverrides gates;  // by metric path; replaces the preset's row
  MechanicsCheck mechanics = MechanicsCheck::kByPreset;
  Length distance_spacing = Length::voxel(0.5);  // side of the pieces on which distances are sampled
};

// The chain's artefacts; null for what the chain did not make.
struct VerifyInputs {
  const Isosurface* isosurface = nullptr;
  const SimplexMesh* simplex_mesh = nullptr;
  const SurfaceMesh* surface = nullptr;
  const TetMesh* tet_mesh = nullptr;
  const TetMesh* reference = nullptr;  // of the undecimated isosurface; for kReference only
  const Hints* hints = nullptr;        // that the stages ran with
};

// What is asked for, kByPreset resolved: kBasic with the presets for finite elements, else kNone.
MechanicsCheck mechanics_of(const VerifyOptions& options);

// Measures (geometry/measure_quality.h, mechanics/fitness.h, reference.h) and applies the gates. Logs a
// warning for each gate that warns or fails, with metric, value, limit and the worst place in mm
// ("quality.warn", "quality.fail"), and one line with the verdict. A tetrahedral mesh without a surface has
// its boundary measured as the surface. Precondition: every path in `gates` is a metric. Deterministic for
// any number of threads.
QualityReport verify(const VerifyInputs& inputs, const VerifyOptions& options, Context& context);

}  // namespace periost
