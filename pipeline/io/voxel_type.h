#pragma once
// How a voxel is stored in a file.
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace periost {

enum class VoxelType { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kInt64, kUint64, kFloat32, kFloat64 };

std::size_t bytes_of(VoxelType type);
// "int16", "float32", ...
std::string_view name_of(VoxelType type);

enum class ByteOrder { kLittle, kBig };

}  // namespace periost
