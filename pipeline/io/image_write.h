#pragma once
// Writes an image or a mask. The file's ending decides the format: .nii .nii.gz .mha .nrrd .vti. Grey values
// are written as float32, masks as uint8 of 0 and 1, little-endian, in the order of memory. The patient frame
// is kept: NIfTI is converted to RAS (sform and qform, single precision as the format has it), the others
// hold LPS exactly. The same image gives the same bytes on every run and machine. The file appears whole or
// not at all.
#include <filesystem>

#include "pipeline/base/context.h"
#include "pipeline/data/image.h"
#include "pipeline/data/mask.h"

namespace periost {

// Throws Error{kUsage, "image.format"} for another ending, Error{kInput, "image.dims"} where NIfTI's 16-bit
// sizes do not suffice, Error{kLimit, "file.…"} when it cannot be written.
void write_image(const std::filesystem::path& path, const Image& image, const Context& context = {});
void write_mask(const std::filesystem::path& path, const Mask& mask, const Context& context = {});

// True when the ending is one of those above; for checks before a run.
bool is_writable_image_format(const std::filesystem::path& path);

}  // namespace periost
