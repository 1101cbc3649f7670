#pragma once
// What a header says of an image: where its voxels lie in the patient and in the file. Each format has one
// function that reads a header into an ImageLayout; reading the voxels is then the same for all of them.
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/data/image.h"
#include "pipeline/io/byte_source.h"
#include "pipeline/io/voxel_type.h"

namespace periost {

// The type of a name such as "int16", or a throw of "image.type" that lists them.
VoxelType voxel_type_from_name(const std::filesystem::path& path, std::string_view name);

struct ImageLayout {
  GridFrame frame;
  VoxelType type = VoxelType::kInt16;
  bool is_big_endian = false;
  double slope = 1;                  // value = slope * stored + intercept
  double intercept = 0;              //
  std::filesystem::path data_file;   // holds the voxels; the header's own file or another one
  Coding coding = Coding::kAuto;     // of the bytes from file_offset on
  std::uint64_t file_offset = 0;     // bytes of data_file before the coded part
  std::uint64_t decoded_offset = 0;  // decoded bytes before the first voxel
  std::string format;                // "NIfTI-1", "NRRD", ...
  std::vector<std::string> notes;    // each a sentence about something assumed; goes to the log
};

// Sizes from a header. Throws "image.dims" unless each is at least 1, fits 32 bits, and the product fits 40
// bits.
std::array<std::int32_t, 3> checked_dims(const std::filesystem::path& path,
                                         const std::array<std::int64_t, 3>& dims);

// The frame whose voxel step along axis a is step[a] (mm, LPS). Throws "image.frame" when a step is zero or
// not finite, or when two of them are off the right angle by more than kShearTolerance (a sheared grid).
// Steps rounded in their file are made exactly orthogonal: the nearest rotation or reflection replaces the
// direction; steps along the axes of the patient are kept to the bit.
inline constexpr double kShearTolerance = 1e-4;  // cosine of the angle between two axes
GridFrame frame_from_steps(const std::filesystem::path& path, const std::array<std::int32_t, 3>& dims,
                           const std::array<Vec3, 3>& step, Vec3 origin);

// The file that a header names for its voxels, beside it or below. Throws "image.path_escape" when it is
// elsewhere.
std::filesystem::path data_file_beside(const std::filesystem::path& header, const std::string& name);

// Headers, by format. Each throws Error{kInput, "image.…"} with what is wrong and where.
ImageLayout nifti_layout(const std::filesystem::path& path);      // .nii .nii.gz .hdr/.img, versions 1 and 2
ImageLayout inv3_layout(const std::filesystem::path& path);       // .inv3, a project of InVesalius
ImageLayout metaimage_layout(const std::filesystem::path& path);  // .mha .mhd
ImageLayout nrrd_layout(const std::filesystem::path& path);       // .nrrd .nhdr
ImageLayout inrimage_layout(const std::filesystem::path& path);   // .inr .inr.gz
ImageLayout vti_layout(const std::filesystem::path& path);  // .vti; its voxels are read by read_vti_voxels
struct RawImageOptions;
ImageLayout raw_layout(const std::filesystem::path& path, const RawImageOptions& raw);

}  // namespace periost
