#include "pipeline/io/image_layout.h"

#include <fmt/format.h>

#include <cmath>
#include <string_view>

namespace periost {
namespace {

struct TypeRow {
  VoxelType type;
  std::string_view name;
  std::size_t bytes;
};
constexpr std::array<TypeRow, 10> kTypes{{{VoxelType::kInt8, "int8", 1},
                                          {VoxelType::kUint8, "uint8", 1},
                                          {VoxelType::kInt16, "int16", 2},
                                          {VoxelType::kUint16, "uint16", 2},
                                          {VoxelType::kInt32, "int32", 4},
                                          {VoxelType::kUint32, "uint32", 4},
                                          {VoxelType::kInt64, "int64", 8},
                                          {VoxelType::kUint64, "uint64", 8},
                                          {VoxelType::kFloat32, "float32", 4},
                                          {VoxelType::kFloat64, "float64", 8}}};

constexpr double kMostVoxels = 1099511627776.0;  // 2^40

// One Newton step to the nearest orthogonal matrix: the mean of the matrix and its inverse transpose.
Mat3 orthogonalise_once(const Mat3& m) {
  const double determinant = m.determinant();
  Mat3 result;
  for (std::size_t a = 0; a < 3; ++a) {
    const Vec3 cofactor = cross(m.column[(a + 1) % 3], m.column[(a + 2) % 3]);
    result.column[a] = (m.column[a] + cofactor / determinant) * 0.5;
  }
  return result;
}

double largest_cosine(const Mat3& m) {
  return std::max({std::abs(dot(m.column[0], m.column[1])), std::abs(dot(m.column[1], m.column[2])),
                   std::abs(dot(m.column[2], m.column[0]))});
}

}  // namespace

std::size_t bytes_of(VoxelType type) {
  return kTypes[static_cast<std::size_t>(type)].bytes;
}
std::string_view name_of(VoxelType type) {
  return kTypes[static_cast<std::size_t>(type)].name;
}

VoxelType voxel_type_from_name(const std::filesystem::path& path, std::string_view name) {
  for (const TypeRow& row : kTypes) {
    if (row.name == name) return row.type;
  }
  refuse_file(path, "image.type", fmt::format("has voxels of type '{}', which is not read", name),
              "types are int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32, float64");
}

std::array<std::int32_t, 3> checked_dims(const std::filesystem::path& path,
                                         const std::array<std::int64_t, 3>& dims) {
  double product = 1;
  for (const std::int64_t size : dims) {
    product *= static_cast<double>(size);
    if (size < 1 || size > INT32_MAX || product > kMostVoxels) {
      refuse_file(path, "image.dims",
                  fmt::format("claims {} x {} x {} voxels, which cannot be", dims[0], dims[1], dims[2]),
                  "every size must be at least 1 and the product at most 2^40");
    }
  }
  return {static_cast<std::int32_t>(dims[0]), static_cast<std::int32_t>(dims[1]),
          static_cast<std::int32_t>(dims[2])};
}

GridFrame frame_from_steps(const std::filesystem::path& path, const std::array<std::int32_t, 3>& dims,
                           const std::array<Vec3, 3>& step, Vec3 origin) {
  GridFrame frame{dims, {}, origin, {}};
  for (std::size_t a = 0; a < 3; ++a) {
    const double length = std::hypot(step[a].x, step[a].y, step[a].z);
    if (!std::isfinite(length) || !(length > 1e-9) || length > 1e9) {
      refuse_file(path, "image.frame",
                  fmt::format("has an impossible voxel step along axis {}: ({}, {}, {}) mm", "ijk"[a],
                              step[a].x, step[a].y, step[a].z),
                  "the spacing must be finite and above zero");
    }
    frame.spacing[a] = length;
    frame.direction.column[a] = step[a] / length;
  }
  if (!is_finite(origin)) refuse_file(path, "image.frame", "has an origin that is not finite");
  const double shear = largest_cosine(frame.direction);
  if (shear > kShearTolerance) {
    refuse_file(
        path, "image.frame",
        fmt::format(
            "has a sheared voxel grid: two axes are {:.4g} degrees off the right angle (at most {:.2g} "
            "is accepted)",
            std::asin(std::min(shear, 1.0)) * 57.29577951308232, kShearTolerance * 57.3),
        "resample it to a rectangular grid first (a tilted gantry is a common cause)");
  }
  for (int iteration = 0; iteration < 4 && largest_cosine(frame.direction) > 0; ++iteration) {
    frame.direction = orthogonalise_once(frame.direction);
  }
  return frame;
}

std::filesystem::path data_file_beside(const std::filesystem::path& header, const std::string& name) {
  const std::filesystem::path data = std::filesystem::path(name).lexically_normal();
  if (name.empty() || data.is_absolute() || *data.begin() == "..") {
    refuse_file(header, "image.path_escape",
                fmt::format("names '{}' for its voxels, which is outside its own folder", name),
                "put the file with the voxels beside the header");
  }
  const std::filesystem::path whole = header.parent_path() / data;
  if (!std::filesystem::exists(whole)) {
    refuse_file(header, "image.missing",
                fmt::format("names '{}' for its voxels, which does not exist", name));
  }
  return whole;
}

}  // namespace periost
