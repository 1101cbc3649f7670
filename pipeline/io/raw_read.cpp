// A file of bare voxels, described by the configuration.
#include <fmt/format.h>

#include "pipeline/io/image_layout.h"
#include "pipeline/io/image_read.h"

namespace periost {

ImageLayout raw_layout(const std::filesystem::path& path, const RawImageOptions& raw) {
  ImageLayout layout;
  layout.format = "raw";
  layout.type = raw.type;
  layout.is_big_endian = raw.endian == ByteOrder::kBig;
  std::array<Vec3, 3> step;
  for (std::size_t a = 0; a < 3; ++a) {
    step[a] = normalized({raw.direction[3 * a], raw.direction[3 * a + 1], raw.direction[3 * a + 2]}) *
              raw.spacing[a];
  }
  layout.frame = frame_from_steps(path, checked_dims(path, raw.dims), step,
                                  {raw.origin[0], raw.origin[1], raw.origin[2]});
  layout.data_file = path;
  layout.decoded_offset = raw.header_bytes;

  // Nothing else tells wrong sizes, so a plain file must have exactly the bytes that they say.
  const ByteSource source(path);
  const std::uint64_t wanted = layout.frame.voxel_count() * bytes_of(layout.type) + raw.header_bytes;
  if (!source.is_compressed() && source.file_bytes() != wanted) {
    refuse_file(path, source.file_bytes() < wanted ? "image.truncated" : "image.dims",
                fmt::format("has {} bytes, but {} header bytes and {} x {} x {} voxels of {} make {}",
                            source.file_bytes(), raw.header_bytes, raw.dims[0], raw.dims[1], raw.dims[2],
                            name_of(raw.type), wanted),
                "check dims, type and header_bytes");
  }
  return layout;
}

}  // namespace periost
