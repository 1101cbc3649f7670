#pragma once
// A mesh in the making, for readers of formats that number their nodes and elements freely.
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <variant>
#include <vector>

#include "pipeline/data/surface_mesh.h"
#include "pipeline/data/tet_mesh.h"

namespace periost {

using AnyMesh = std::variant<SurfaceMesh, TetMesh>;

// Throws Error{kInput, code}: "PLACE: WHAT", with what to do about it.
[[noreturn]] void refuse_mesh(
    const char* code, const std::string& place, const std::string& what,
    const std::string& hint = "export the mesh again, or repair it where it was made");

// A word of a file that is fit to print: at most 24 characters, everything beyond printable ASCII as '?'.
std::string printable(std::string_view word);

// Refuses what is wrong with a node or element as soon as it comes, with the place that the reader is at.
// Memory follows from what was added; there is nothing to announce.
class MeshBuilder {
 public:
  // `place` says where the reader is: "femur.msh:17" or "femur.msh: byte 4711".
  explicit MeshBuilder(std::function<std::string()> place) : place_(std::move(place)) {}

  // Throws Error{kInput, "mesh.not_finite" | "mesh.malformed" (a number used twice)}.
  void add_node(std::uint64_t number, Vec3 position);
  // 4 or 10 node numbers in VTK's order (tet_mesh.h). Throws Error{kInput, "mesh.bad_index" |
  // "mesh.unsupported" (orders that are mixed)}.
  void add_tet(const std::vector<std::uint64_t>& nodes, std::int32_t region);
  // The corners of a triangle: the mesh, if there is no tetrahedron.
  void add_triangle(const std::vector<std::uint64_t>& nodes);

  std::size_t node_count() const { return points_.size(); }
  // A TetMesh with its boundary if there were tetrahedra, else a surface of the triangles, as read. Leaves
  // the builder empty. Throws Error{kInput, "mesh.empty"}.
  AnyMesh finish();

 private:
  Index find(std::uint64_t number) const;

  std::function<std::string()> place_;
  std::unordered_map<std::uint64_t, Index> index_;
  std::vector<Vec3> points_;
  std::vector<Tetrahedron> tets_;
  std::vector<MidsideNodes> midside_;
  std::vector<std::int32_t> region_;
  std::vector<Triangle> triangles_;
};

}  // namespace periost
