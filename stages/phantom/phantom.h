#pragma once
// Synthetic images with a known truth behind them, for examples, tests and benchmarks.
#include <array>
#include <cstdint>
#include <optional>

#include "pipeline/base/context.h"
#include "pipeline/data/image.h"

namespace periost {

// What the image shows, and the threshold that finds it. "Grey" shapes cross their threshold linearly over
// three voxels, so that the isosurface is subvoxel; "binary" ones hold 0 and 1 only.
enum class PhantomShape {
  kSphere,     // grey 0..1000, threshold 500
  kTorus,      // grey 0..1000, threshold 500; its ring lies in the plane of i and j
  kCube,       // binary, threshold 0.5: a rotated cube, all stairs; about 23,200 triangles
  kVentricle,  // binary, threshold 0.5: two curved, tapering horned bodies; about 40,000 triangles
  kVessel,     // HU, threshold 190: a branching tree, 340 in tissue of 40; about 126,000 triangles
  kFemur,      // HU, threshold 226: marrow -50..100, trabecular bone 200..500, cortex 1200..1800, muscle 40
  kNoise,      // whole numbers 0..7 at random, threshold 4, which many voxels equal
  kSheets,     // grey 0..1000, threshold 500: thin, near-parallel curved plates two voxels apart
};

struct PhantomOptions {
  PhantomShape shape{PhantomShape::kSphere};
  std::optional<std::array<std::int32_t, 3>> size{};  // voxels along i, j, k; none: the shape's own
  std::optional<Vec3> spacing{};                      // mm; none: the shape's own
  Vec3 origin{};                                      // centre of the first voxel, LPS mm
  std::array<double, 9> direction{1, 0, 0, 0, 1,
                                  0, 0, 0, 1};  // unit axes i, j, k in LPS, one after the other
  std::optional<double>
      radius{};            // mm; sphere, ring of the torus, half side of the cube; none: fits the image
  double noise = 0;        // standard deviation: of grey values; of the surface in voxels for binary shapes
  std::uint64_t seed = 0;  // of the noise, the branches of `vessel`, the texture of `femur`
};

// The image. `ventricle`, `vessel`, `femur` and `sheets` are scaled to fill the image of any size; every
// shape is placed in its middle. A pure function of the options: the same bits for any number of threads, and
// on any machine (only arithmetic and square roots are used). Throws Error{kUsage}: "phantom.size" unless
// every side is 1 or more and the image is below 2^36 voxels, "phantom.spacing" unless positive,
// "phantom.direction" unless orthonormal within 1e-6.
Image make_phantom(const PhantomOptions& options, const Context& context);

}  // namespace periost
