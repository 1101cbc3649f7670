#pragma once
// Reads an image of any supported format into the patient frame LPS, millimetres. The order of voxels in
// memory stays as in the file; orientation goes into the frame's direction, whose determinant may be
// negative. See docs/images.md for the formats and for what is done about each irregularity.
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/base/context.h"
#include "pipeline/data/image.h"
#include "pipeline/io/voxel_type.h"

namespace periost {

// A file without a header.
struct RawImageOptions {
  std::array<std::int64_t, 3> dims{0, 0, 0};  // voxels along i (fastest), j, k
  VoxelType type = VoxelType::kInt16;         // how one is stored
  std::array<double, 3> spacing{1, 1, 1};     // mm
  std::array<double, 3> origin{0, 0, 0};      // mm, LPS, centre of the first voxel
  std::array<double, 9> direction{1, 0, 0, 0, 1,
                                  0, 0, 0, 1};  // unit vectors of i, j, k in LPS, one after the other
  ByteOrder endian = ByteOrder::kLittle;        // order of the bytes of one voxel
  std::uint64_t header_bytes = 0;               // bytes to skip
};

struct ImageFileOptions {
  std::optional<RawImageOptions> raw;  // set: the file is raw, whatever its name
  bool replace_non_finite =
      false;  // NaN and infinite voxels get the lowest finite value; else they are refused
};

// Memory: 4 bytes a voxel and a small buffer; it grows with the bytes that arrive, so a header that lies
// costs nothing. What had to be assumed (a frame that the format does not state) is one line of the log each.
// Throws Error{kInput, "image.…"}: missing, unreadable, format, header, dims, type, frame, truncated,
// corrupt, not_finite, path_escape, dicom.
Image read_image(const std::filesystem::path& path, const ImageFileOptions& options = {},
                 const Context& context = {});

// What the header alone tells. Throws as above, except for what only the voxels can tell.
struct ImageHeader {
  GridFrame frame;
  VoxelType type = VoxelType::kInt16;
  std::string format;                        // "NIfTI-1", "NRRD", ...
  std::vector<std::filesystem::path> files;  // the file, and the one with the voxels if that is another
};
ImageHeader read_image_header(const std::filesystem::path& path, const ImageFileOptions& options = {});
GridFrame read_image_frame(const std::filesystem::path& path, const ImageFileOptions& options = {});

// One line such as "512 x 512 x 200 voxels of 0.7 x 0.7 x 1 mm, axes L P S, origin (-120, -110, 40)". The
// three letters are the directions in the patient to which i, j, k mostly grow; a tilt of over a degree is
// added.
std::string describe(const GridFrame& frame);

}  // namespace periost
