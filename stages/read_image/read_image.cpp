#include "stages/read_image/read_image.h"

#include <fmt/format.h>

#include <algorithm>

namespace periost {

ImageFileOptions file_options(const ReadImageOptions& options) {
  return {options.raw, options.non_finite == NonFinite::kLowest};
}

Image read_image(const ReadImageOptions& options, const Context& context) {
  const ImageHeader header = read_image_header(options.path, file_options(options));
  context.info("image.header", fmt::format("{}: {}, stored as {}", header.format, describe(header.frame),
                                           name_of(header.type)));
  Image image = read_image(options.path, file_options(options), context);
  const auto [low, high] = std::minmax_element(image.values.begin(), image.values.end());
  context.info("image.range", fmt::format("values from {} to {}", *low, *high));
  return image;
}

}  // namespace periost
