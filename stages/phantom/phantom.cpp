#include "stages/phantom/phantom.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "pipeline/base/error.h"
#include "pipeline/base/parallel.h"
#include "pipeline/base/random.h"
#include "stages/phantom/shapes.h"

namespace periost {
namespace {

// Streams of random numbers: one for each row of voxels, kept apart from those of the shapes.
constexpr std::uint64_t kRowStreams = std::uint64_t{1} << 40;

struct ShapeDefaults {
  std::array<std::int32_t, 3> size;
  Vec3 spacing;
};

ShapeDefaults defaults_of(PhantomShape shape) {
  switch (shape) {
    case PhantomShape::kTorus:
      return {{80, 80, 40}, {1, 1, 1}};
    case PhantomShape::kCube:
      return {{72, 72, 72}, {1, 1, 1}};
    case PhantomShape::kVentricle:
      return {{88, 118, 68}, {1, 1, 1}};
    case PhantomShape::kVessel:
      return {{256, 256, 80}, {0.33, 0.33, 1.0}};
    case PhantomShape::kFemur:
      return {{104, 84, 234}, {1, 1, 2}};
    case PhantomShape::kNoise:
      return {{32, 32, 32}, {1, 1, 1}};
    case PhantomShape::kSphere:
    case PhantomShape::kSheets:
      break;
  }
  return {{64, 64, 64}, {1, 1, 1}};
}

// Roughly normal with deviation 1: the sum of twelve uniform numbers, from arithmetic alone.
double normal(Random& random) {
  constexpr double kMean = 6;
  double sum = 0;
  for (int n = 0; n < 3; ++n) {
    std::uint64_t bits = random.next();
    for (int part = 0; part < 4; ++part, bits >>= 16) sum += static_cast<double>(bits & 0xFFFF) * 0x1p-16;
  }
  return sum - kMean;
}

// One row of voxels to be filled; `depths` is room for as many numbers.
struct Row {
  Line line;  // mm from the image's middle
  std::size_t count = 0;
  float* values = nullptr;
  Random random{0, 0};
  std::vector<double> depths;
};
using FillRow = std::function<void(Row&)>;
// Sets row.depths: how deep each voxel lies below the shape's surface, mm, positive inside.
using FindDepths = std::function<void(Row&)>;

// Everything a shape is made from.
struct Scene {
  const PhantomOptions& options;
  Vec3 box;          // mm
  double voxel = 1;  // mm, the largest side

  double radius_or(double share_of_smallest_side) const {
    return options.radius.value_or(share_of_smallest_side * std::min({box.x, box.y, box.z}));
  }
};

// A grey ramp: `outside` to `inside` over three voxels around depth 0.
double ramp(double depth, double voxel, double outside, double inside) {
  return outside + (inside - outside) * std::clamp(0.5 + depth / (3 * voxel), 0.0, 1.0);
}

// Rows of a grey shape from its depths.
FillRow grey_rows(const Scene& scene, double outside, double inside, FindDepths find_depths) {
  return [scene, outside, inside, find_depths = std::move(find_depths)](Row& row) {
    find_depths(row);
    for (std::size_t i = 0; i < row.count; ++i) {
      double value = ramp(row.depths[i], scene.voxel, outside, inside);
      if (scene.options.noise > 0) value += scene.options.noise * normal(row.random);
      row.values[i] = static_cast<float>(value);
    }
  };
}

// Rows of a binary shape; noise moves its surface, in bumps of two and a half voxels.
FillRow binary_rows(const Scene& scene, FindDepths find_depths) {
  return [scene, find_depths = std::move(find_depths)](Row& row) {
    find_depths(row);
    const double noise = scene.options.noise * scene.voxel;
    const double bump = 2.5 * scene.voxel;
    for (std::size_t i = 0; i < row.count; ++i) {
      double depth = row.depths[i];
      if (std::abs(depth) < noise)
        depth += noise * smooth_noise(scene.options.seed, row.line.point(i) / bump);
      row.values[i] = depth >= 0 ? 1.0f : 0.0f;
    }
  };
}

FindDepths by_point(std::function<double(Vec3)> depth) {
  return [depth = std::move(depth)](Row& row) {
    for (std::size_t i = 0; i < row.count; ++i) row.depths[i] = depth(row.line.point(i));
  };
}

FindDepths by_body(Body body, double margin) {
  return [body = std::move(body), margin](Row& row) { depths_on_line(body, row.line, margin, row.depths); };
}

FillRow sphere(const Scene& scene) {
  const double radius = scene.radius_or(0.375);
  return grey_rows(scene, 0, 1000, by_point([radius](Vec3 p) { return radius - norm(p); }));
}

FillRow torus(const Scene& scene) {
  const double ring = scene.radius_or(0.6);
  return grey_rows(scene, 0, 1000, by_point([ring](Vec3 p) {
                     const double out = std::sqrt(p.x * p.x + p.y * p.y) - ring;
                     return 0.4 * ring - std::sqrt(out * out + p.z * p.z);
                   }));
}

FillRow cube(const Scene& scene) {
  // A rotation without symmetry to the grid.
  const Vec3 u = normalized(Vec3{5, 2, 1});
  const Vec3 w = normalized(cross(u, Vec3{-1, 4, 2}));
  const Mat3 axes{{u, cross(w, u), w}};
  const double half = scene.radius_or(0.251);
  return binary_rows(scene, by_point([axes, half](Vec3 p) {
                       const Vec3 q = axes.transposed_times(p);
                       return half - std::max({std::abs(q.x), std::abs(q.y), std::abs(q.z)});
                     }));
}

FillRow ventricle(const Scene& scene) {
  return binary_rows(scene, by_body(ventricle_body(scene.box), scene.options.noise * scene.voxel));
}

FillRow vessel(const Scene& scene) {
  return grey_rows(scene, 40, 340, by_body(vessel_body(scene.box, scene.options.seed), 3 * scene.voxel));
}

FillRow noise(const Scene&) {
  return [](Row& row) {
    for (std::size_t i = 0; i < row.count; ++i) row.values[i] = static_cast<float>(row.random.below(8));
  };
}

FillRow sheets(const Scene& scene) {
  // Plates of 1.6 voxels with gaps of two, bent and tilted a little differently each.
  const double pitch = 3.6 * scene.voxel;
  const double half = 0.8 * scene.voxel;
  const double rim = 0.42 * std::min(scene.box.x, scene.box.y);
  const double rise = scene.box.z / (rim * rim);
  constexpr int kPlates = 5;
  return grey_rows(
      scene, 0, 1000, by_point([=](Vec3 p) {
        double depth = -1e9;
        const double r_squared = p.x * p.x + p.y * p.y;
        for (int n = 0; n < kPlates; ++n) {
          const double height = (n - kPlates / 2) * pitch + 0.1 * rise * r_squared + 0.004 * (n - 2) * p.x;
          depth = std::max(depth, std::min(half - std::abs(p.z - height), rim - std::sqrt(r_squared)));
        }
        return depth;
      }));
}

// Grey values of a thigh in HU, each tissue with its own texture; tissues mix over one voxel at their
// borders.
double femur_value(const Femur& bone, const Scene& scene, double depth, Vec3 p) {
  constexpr double kMuscle = 40;
  const auto share = [&](double d) { return std::clamp(0.5 + d / scene.voxel, 0.0, 1.0); };
  const double outer = share(depth);
  if (outer == 0) return kMuscle;
  const std::uint64_t seed = scene.options.seed;
  const double cortex = 1500 + 300 * smooth_noise(seed + 1, p / (8 * bone.scale));
  const double inner = share(depth - bone.cortex_mm(p.z));
  if (inner == 0) return kMuscle + outer * (cortex - kMuscle);
  const double marrow = 25 + 75 * smooth_noise(seed + 2, p / (5 * bone.scale));
  const double trabecular = 350 + 150 * smooth_noise(seed + 3, p / (2.5 * bone.scale));
  const double spongy = bone.trabecular_share(p.z);
  return cortex + inner * (marrow + spongy * (trabecular - marrow) - cortex);
}

FillRow femur_rows(const Scene& scene) {
  const Femur bone = femur(scene.box);
  return [scene, bone, find_depths = by_body(bone.outer, 3 * scene.voxel)](Row& row) {
    find_depths(row);
    for (std::size_t i = 0; i < row.count; ++i) {
      double value = femur_value(bone, scene, row.depths[i], row.line.point(i));
      if (scene.options.noise > 0) value += scene.options.noise * normal(row.random);
      row.values[i] = static_cast<float>(value);
    }
  };
}

FillRow rows_of(const Scene& scene) {
  switch (scene.options.shape) {
    case PhantomShape::kSphere:
      return sphere(scene);
    case PhantomShape::kTorus:
      return torus(scene);
    case PhantomShape::kCube:
      return cube(scene);
    case PhantomShape::kVentricle:
      return ventricle(scene);
    case PhantomShape::kVessel:
      return vessel(scene);
    case PhantomShape::kFemur:
      return femur_rows(scene);
    case PhantomShape::kNoise:
      return noise(scene);
    case PhantomShape::kSheets:
      break;
  }
  return sheets(scene);
}

GridFrame frame_of(const PhantomOptions& options) {
  const ShapeDefaults defaults = defaults_of(options.shape);
  GridFrame frame{
      options.size.value_or(defaults.size), options.spacing.value_or(defaults.spacing), options.origin, {}};
  double voxels = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    const double* axis = &options.direction[3 * a];
    frame.direction.column[a] = {axis[0], axis[1], axis[2]};
    voxels *= frame.dims[a];
    if (frame.dims[a] < 1 || voxels > 0x1p36) {
      throw Error(ErrorKind::kUsage, "phantom.size",
                  "the size of a phantom must be at least 1 voxel along each axis "
                  "and at most 2^36 voxels in all");
    }
    if (!(frame.spacing[a] > 0) || !std::isfinite(frame.spacing[a])) {
      throw Error(ErrorKind::kUsage, "phantom.spacing",
                  "the spacing of a phantom must be above 0 mm along each axis");
    }
  }
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t b = a; b < 3; ++b) {
      const double product = dot(frame.direction.column[a], frame.direction.column[b]);
      if (std::abs(product - (a == b ? 1 : 0)) <= 1e-6) continue;
      throw Error(ErrorKind::kUsage, "phantom.direction",
                  "the axes of a phantom's direction must be unit vectors at "
                  "right angles");
    }
  }
  return frame;
}

}  // namespace

Image make_phantom(const PhantomOptions& options, const Context& context) {
  Image image{frame_of(options), {}};
  const GridFrame& frame = image.frame;
  const auto& dims = frame.dims;
  const Scene scene{options,
                    {dims[0] * frame.spacing.x, dims[1] * frame.spacing.y, dims[2] * frame.spacing.z},
                    frame.largest_spacing()};
  image.values.resize(frame.voxel_count());
  const FillRow fill = rows_of(scene);
  Progress progress(context, "making the phantom", static_cast<std::uint64_t>(dims[2]));
  parallel_for(context, static_cast<std::size_t>(dims[2]), [&](std::size_t slice) {
    const auto k = static_cast<std::int32_t>(slice);
    for (std::int32_t j = 0; j < dims[1]; ++j) {
      const auto from_middle = [&](std::int32_t n, std::size_t a) {
        return (n - 0.5 * (dims[a] - 1)) * frame.spacing[a];
      };
      const std::uint64_t number =
          slice * static_cast<std::uint64_t>(dims[1]) + static_cast<std::uint64_t>(j);
      Row row{{from_middle(0, 0), frame.spacing.x, from_middle(j, 1), from_middle(k, 2)},
              static_cast<std::size_t>(dims[0]),
              &image.values[frame.offset(0, j, k)],
              Random(options.seed, kRowStreams + number),
              std::vector<double>(static_cast<std::size_t>(dims[0]))};
      fill(row);
    }
    progress.step();
  });
  return image;
}

}  // namespace periost
