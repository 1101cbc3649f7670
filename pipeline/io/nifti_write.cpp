#include "pipeline/io/nifti_write.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <string_view>

namespace periost {
namespace {

constexpr std::int16_t kScannerFrame = 1;
constexpr char kMillimetres = 2;

using Header = std::array<unsigned char, 352>;

template <class T>
void put(Header& header, std::size_t offset, T value) {
  const auto bytes = std::bit_cast<std::array<unsigned char, sizeof(T)>>(value);
  std::copy(bytes.begin(), bytes.end(), header.begin() + static_cast<std::ptrdiff_t>(offset));
}
void put_real(Header& header, std::size_t offset, double value) {
  put(header, offset, static_cast<float>(value) + 0.0F);  // no negative zero
}

// x and y change sign between LPS and RAS.
Vec3 to_ras(Vec3 lps) {
  return {-lps.x, -lps.y, lps.z};
}

}  // namespace

NiftiQuaternion nifti_quaternion(const Mat3& direction) {
  NiftiQuaternion result;
  Mat3 m = direction;
  if (m.determinant() < 0) {
    result.qfac = -1;
    m.column[2] = -m.column[2];
  }
  const auto at = [&](std::size_t row, std::size_t column) { return m.column[column][row]; };
  // Four times the square of each component; the largest is computed first, the others from it, so that no
  // digits are lost at half turns.
  const std::array<double, 4> squares{1 + at(0, 0) + at(1, 1) + at(2, 2), 1 + at(0, 0) - at(1, 1) - at(2, 2),
                                      1 - at(0, 0) + at(1, 1) - at(2, 2), 1 - at(0, 0) - at(1, 1) + at(2, 2)};
  const auto largest = std::max_element(squares.begin(), squares.end()) - squares.begin();
  const double main = 0.5 * std::sqrt(squares[static_cast<std::size_t>(largest)]);
  const double s = 0.25 / main;
  std::array<double, 4> q{};  // a, b, c, d
  switch (largest) {
    case 0:
      q = {main, s * (at(2, 1) - at(1, 2)), s * (at(0, 2) - at(2, 0)), s * (at(1, 0) - at(0, 1))};
      break;
    case 1:
      q = {s * (at(2, 1) - at(1, 2)), main, s * (at(0, 1) + at(1, 0)), s * (at(0, 2) + at(2, 0))};
      break;
    case 2:
      q = {s * (at(0, 2) - at(2, 0)), s * (at(0, 1) + at(1, 0)), main, s * (at(1, 2) + at(2, 1))};
      break;
    default:
      q = {s * (at(1, 0) - at(0, 1)), s * (at(0, 2) + at(2, 0)), s * (at(1, 2) + at(2, 1)), main};
  }
  // The format leaves out a, which is then taken as not negative.
  const double sign = q[0] < 0 ? -1 : 1;
  result.b = sign * q[1];
  result.c = sign * q[2];
  result.d = sign * q[3];
  return result;
}

Header nifti_header(const GridFrame& frame, VoxelType type) {
  Header header{};
  put(header, 0, std::int32_t{348});
  put(header, 38, 'r');
  put(header, 40, std::int16_t{3});
  for (std::size_t a = 0; a < 7; ++a) {
    put(header, 42 + 2 * a, static_cast<std::int16_t>(a < 3 ? frame.dims[a] : 1));
  }
  put(header, 70, static_cast<std::int16_t>(type == VoxelType::kUint8 ? 2 : 16));
  put(header, 72, static_cast<std::int16_t>(8 * bytes_of(type)));

  Mat3 direction = frame.direction;
  for (Vec3& column : direction.column) column = to_ras(column);
  const NiftiQuaternion quaternion = nifti_quaternion(direction);
  put_real(header, 76, quaternion.qfac);
  for (std::size_t a = 0; a < 3; ++a) put_real(header, 80 + 4 * a, frame.spacing[a]);
  put_real(header, 108, 352);  // first voxel
  put_real(header, 112, 1);    // slope
  put(header, 123, kMillimetres);
  put(header, 252, kScannerFrame);
  put(header, 254, kScannerFrame);
  put_real(header, 256, quaternion.b);
  put_real(header, 260, quaternion.c);
  put_real(header, 264, quaternion.d);
  const Vec3 origin = to_ras(frame.origin);
  for (std::size_t row = 0; row < 3; ++row) {
    put_real(header, 268 + 4 * row, origin[row]);
    for (std::size_t a = 0; a < 3; ++a) {
      put_real(header, 280 + 16 * row + 4 * a, direction.column[a][row] * frame.spacing[a]);
    }
    put_real(header, 280 + 16 * row + 12, origin[row]);
  }
  constexpr std::string_view kMagic("n+1\0", 4);
  std::copy(kMagic.begin(), kMagic.end(), header.begin() + 344);
  return header;
}

}  // namespace periost
