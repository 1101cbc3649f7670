#pragma once
// Which shells of a surface bound bodies and which bound cavities, by how deep they are nested.
#include <cstdint>
#include <vector>

#include "pipeline/base/context.h"
#include "pipeline/data/surface_mesh.h"

namespace periost {

// A shell is a connected piece of the surface. One inside an even number of others is the outside of a body,
// one inside an odd number the wall of a cavity of the body around it.
struct Bodies {
  std::vector<std::uint32_t> shell_of_triangle;
  std::vector<int> depth;            // per shell: how many others it lies inside
  std::vector<std::int32_t> number;  // per shell: its body, from 1 in the order of the outer shells
  std::vector<Vec3> cavity_seeds;    // a point just inside each cavity, in the order of the shells
  std::uint32_t turned_shells = 0;   // shells whose normals contradict their depth

  std::size_t body_count() const;
};

// Nesting by exact parity of rays. Precondition: the surface passes check_fillable(). About the number of
// triangles times the number of shells within one another's boxes. Throws Error{kInternal} where no seed
// could be found, which needs a cavity thinner than the rounding of coordinates.
Bodies find_bodies(const SurfaceMesh& surface, const Context& context);

}  // namespace periost
