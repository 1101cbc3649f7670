#pragma once
// Which shells of a surface bound bodies and which bound cavities, by how deep they are nested.
#include <cstdint>
#include <vector>

#include "pipeline/base/context.h"
#include "pipeline/data/surface_mesh.h"
#include "stages/tetgen/tetgen.h"

namespace periost {

// A shell is a connected piece of the surface. One inside an even number of others is the outside of a body,
// one inside an odd number the wall of a cavity of the body around it.
struct Bodies {
  std::vector<std::uint32_t> shell_of_triangle;
  std::vector<int> depth;  // per shell: how many others it lies inside
  std::vector<std::int32_t>
      number;  // per shell: its region, from 1: bodies in the order of their outer shells,
               // then filled cavities; the wall of an empty one has its body's number
  std::vector<Vec3> cavity_seeds;   // a point inside each empty cavity, in the order of the shells
  std::vector<Vec3> region_seeds;   // with filled cavities: per shell, a point inside it and no deeper one
  std::uint32_t turned_shells = 0;  // shells whose normals contradict their depth

  std::size_t body_count() const;
};

// Nesting by exact parity of rays. Every seed is proved by the same test to lie inside its shell and as deep
// as it should. Precondition: the surface passes check_fillable(). About the number of triangles times the
// number of shells within one another's boxes. Throws Error{kInternal} where no seed could be found, which
// needs a cavity thinner than the rounding of coordinates.
Bodies find_bodies(const SurfaceMesh& surface, Cavities cavities, const Context& context);

}  // namespace periost
