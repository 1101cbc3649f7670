#pragma once
// The 352 bytes before the voxels of a NIfTI-1 file.
#include <array>

#include "pipeline/data/grid_frame.h"
#include "pipeline/io/image_layout.h"

namespace periost {

// Little-endian, with sform and qform of code 1 (scanner), unit mm, no scaling and no text: nothing in it
// depends on the time or the machine. Precondition: sizes fit 16 bits; type is float32 or uint8.
std::array<unsigned char, 352> nifti_header(const GridFrame& frame, VoxelType type);

// A rotation as NIfTI's quaternion (b, c, d), and qfac: 1, or -1 when the third axis has to be turned round
// to make the direction a rotation.
struct NiftiQuaternion {
  double b = 0, c = 0, d = 0;
  double qfac = 1;
};
// Precondition: `direction` (in RAS) is orthonormal; its determinant may be negative.
NiftiQuaternion nifti_quaternion(const Mat3& direction);

}  // namespace periost
