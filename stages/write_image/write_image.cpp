#include "stages/write_image/write_image.h"

#include "pipeline/base/error.h"
#include "pipeline/io/image_write.h"

namespace periost {

std::filesystem::path written_path(const WriteImageOptions& options) {
  if (!options.path.empty()) return options.path;
  return options.volume == WrittenVolume::kMask ? "mask.nii.gz" : "image.nii.gz";
}

Deck write_image(const Image* image, const Mask* mask, const WriteImageOptions& options,
                 const Context& context) {
  const std::filesystem::path path = written_path(options);
  if (options.volume == WrittenVolume::kMask) {
    PERIOST_ASSERT(mask != nullptr);
    write_mask(context.output / path, *mask, context);
  } else {
    PERIOST_ASSERT(image != nullptr);
    write_image(context.output / path, *image, context);
  }
  return {{path.string()}};
}

}  // namespace periost
