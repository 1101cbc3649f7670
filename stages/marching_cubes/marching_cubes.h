#pragma once
// The isosurface of a mask, subvoxel where a grey image stands behind it (marching cubes of Lorensen and
// Cline 1987, made closed by the asymptotic decider of Nielson and Hamann 1991).
#include "pipeline/base/context.h"
#include "pipeline/data/image.h"
#include "pipeline/data/isosurface.h"
#include "pipeline/data/keep_components.h"
#include "pipeline/data/mask.h"

namespace periost {

struct MarchingCubesOptions {
  // Leave the surface open where the object touches the image border, instead of closing it with a flat cap
  // half a voxel outside the border voxels' centres.
  bool open = false;
  KeepComponents keep{};  // connected surfaces that stay, by number of triangles
};

// The surface between the voxels inside the mask and those outside. With `image` and a mask that has a range,
// vertices lie where the linearly interpolated grey value meets the threshold; a voxel that the mask holds
// against the threshold (a hole filled, a fragment removed) counts as just inside or just outside. Without
// either, vertices lie midway between voxels.
//
// Guarantees: closed (unless `open`), manifold, oriented outward in LPS for either handedness of the grid,
// without degenerate or crossing triangles, also where values equal the threshold. The edge parameter of a
// vertex stays within [0.02, 0.98]. Bits do not depend on the number of threads. Time: linear in voxels
// (a few bits each) plus triangles.
//
// Throws Error: kInput "marching_cubes.grid" if image and mask lie on different grids; kInput
// "marching_cubes.empty" if there is no surface; kLimit "marching_cubes.too_large" past 2^32 - 1 triangles.
Isosurface marching_cubes(const Image* image, const Mask& mask, const MarchingCubesOptions& options,
                          const Context& context);

// The same for all voxels of an image within a range of values.
Isosurface marching_cubes(const Image& image, const ThresholdRange& range,
                          const MarchingCubesOptions& options, const Context& context);

}  // namespace periost
