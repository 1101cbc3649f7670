#pragma once
// Laplacian smoothing of a surface by Taubin's two steps (1995), which keep it from shrinking.
#include "pipeline/base/context.h"
#include "pipeline/data/surface_mesh.h"

namespace smoothing_example {

struct LaplacianSmoothingOptions {
  std::uint32_t iterations = 10;  // pairs of a smoothing and an inflating step
  double smoothing = 0.5;         // lambda: share of the way to the mean of the neighbours
  double inflation = 0.53;        // mu: share of the way back; 0 is the plain Laplacian, which shrinks
};

// Moves the points only: triangles stay as they are, so a closed surface stays closed. It may come to
// intersect itself; points of a boundary stay where they are. Deterministic; O(iterations * triangles).
// Throws Error{kInterrupted} only.
periost::SurfaceMesh smooth(const periost::SurfaceMesh& mesh, const LaplacianSmoothingOptions& options,
                            const periost::Context& context);

}  // namespace smoothing_example
