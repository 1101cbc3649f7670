#pragma once
// Measures everything that quality.json reports of a surface, of a tetrahedral mesh, and of their distance to
// the isosurface, with the worst elements of each metric. Definitions of the metrics: triangle_quality.h,
// tet_quality.h, topology.h, surface_distance.h; docs/quality.md.
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/base/context.h"
#include "pipeline/base/quantity.h"
#include "pipeline/data/quality_report.h"
#include "pipeline/data/simplex_mesh.h"
#include "pipeline/data/surface_mesh.h"
#include "pipeline/data/tet_mesh.h"

namespace periost {

// The worst ten elements by the path of a metric or of a distribution ("volume.min_dihedral_deg").
using WorstElements = std::map<std::string, std::vector<WorstElement>>;

struct Measurement {
  QualityReport report;  // without gates; verdict pass
  WorstElements worst;
};

// What there is to measure; null for what there is not.
struct QualityInputs {
  const SurfaceMesh* isosurface = nullptr;  // the reference of all distances
  const DecimationReport* decimation = nullptr;
  const SurfaceMesh* surface = nullptr;
  const TetMesh* tet_mesh = nullptr;
  double voxel_mm = 0;  // unit of distances; 0: the isosurface's, else the surface's, else millimetres
};

struct MeasureOptions {
  // Side of the pieces on which distances are sampled; the mean edge where voxels are asked and there are
  // none.
  Length distance_spacing = Length::voxel(0.5);
  bool self_intersections = true;
};

// Deterministic for any number of threads. Reports what its inputs allow: distance, volume change and equal
// topology need isosurface and surface, smoothness a manifold surface. Preconditions: indices in range,
// points finite.
Measurement measure_quality(const QualityInputs& inputs, const MeasureOptions& options,
                            const Context& context);

}  // namespace periost
