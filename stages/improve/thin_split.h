#pragma once
// Puts points between the two sides of thin walls, where tetrahedra reach from one side to the other and no
// point inside lets stress vary across.
#include <cstddef>

#include "stages/improve/tet_complex.h"

namespace periost {

// Splits, in its middle, every edge inside the body that joins two points on the boundary, longest first,
// where all tetrahedra that come out have dihedral angles between 20 and 160 degrees. At most `room`
// tetrahedra are added. Returns how many edges were split.
std::size_t split_thin_walls(TetComplex& complex, std::size_t room);

}  // namespace periost
