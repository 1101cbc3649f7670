#pragma once
// Leaves an image or a mask in the output folder, for a look in another program.
#include <filesystem>

#include "pipeline/base/context.h"
#include "pipeline/data/deck.h"
#include "pipeline/data/image.h"
#include "pipeline/data/mask.h"

namespace periost {

enum class WrittenVolume { kImage, kMask };

struct WriteImageOptions {
  std::filesystem::path path;  // relative to the output folder; empty: image.nii.gz or mask.nii.gz
  WrittenVolume volume = WrittenVolume::kImage;  // which of the two inputs
};

// The path with its default.
std::filesystem::path written_path(const WriteImageOptions& options);

// Precondition: the chosen one is not null. Errors as write_image(path, image).
Deck write_image(const Image* image, const Mask* mask, const WriteImageOptions& options,
                 const Context& context);

}  // namespace periost
