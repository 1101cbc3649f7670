#include "pipeline/io/mesh_builder.h"

#include <fmt/format.h>

#include "pipeline/base/error.h"
#include "pipeline/geometry/tet_faces.h"

namespace periost {

void refuse_mesh(const char* code, const std::string& place, const std::string& what,
                 const std::string& hint) {
  throw Error(ErrorKind::kInput, code, fmt::format("{}: {}", place, what), hint);
}

std::string printable(std::string_view word) {
  constexpr std::size_t kLongest = 24;
  std::string text(word.substr(0, kLongest));
  for (char& c : text) {
    if (c < ' ' || c > '~') c = '?';
  }
  return word.size() > kLongest ? text + "..." : text;
}

Index MeshBuilder::find(std::uint64_t number) const {
  const auto found = index_.find(number);
  if (found == index_.end()) {
    refuse_mesh("mesh.bad_index", place_(),
                fmt::format("the element names node {}, which is not defined", number));
  }
  return found->second;
}

void MeshBuilder::add_node(std::uint64_t number, Vec3 position) {
  if (!is_finite(position)) {
    refuse_mesh("mesh.not_finite", place_(),
                fmt::format("node {} has a coordinate that is not finite", number));
  }
  if (!index_.emplace(number, static_cast<Index>(points_.size())).second) {
    refuse_mesh("mesh.malformed", place_(), fmt::format("node {} is defined twice", number));
  }
  points_.push_back(position);
}

void MeshBuilder::add_tet(const std::vector<std::uint64_t>& nodes, std::int32_t region) {
  if (!tets_.empty() && (nodes.size() == 10) == midside_.empty()) {
    refuse_mesh("mesh.unsupported", place_(), "tetrahedra of first and of second order are mixed",
                "export all elements in one order");
  }
  Tetrahedron corners;
  for (std::size_t k = 0; k < 4; ++k) corners[k] = find(nodes[k]);
  tets_.push_back(corners);
  region_.push_back(region);
  if (nodes.size() != 10) return;
  MidsideNodes middle;
  for (std::size_t k = 0; k < 6; ++k) middle[k] = find(nodes[4 + k]);
  midside_.push_back(middle);
}

void MeshBuilder::add_triangle(const std::vector<std::uint64_t>& nodes) {
  triangles_.push_back({find(nodes[0]), find(nodes[1]), find(nodes[2])});
}

AnyMesh MeshBuilder::finish() {
  index_.clear();
  if (tets_.empty()) {
    if (triangles_.empty()) refuse_mesh("mesh.empty", place_(), "it holds neither tetrahedra nor triangles");
    SurfaceMesh surface;
    surface.points = std::move(points_);
    surface.triangles = std::move(triangles_);
    surface.was_read = true;
    return surface;
  }
  TetMesh mesh;
  mesh.points = std::move(points_);
  mesh.tets = std::move(tets_);
  mesh.midside = std::move(midside_);
  mesh.region = std::move(region_);
  for (const BoundaryFace& at : boundary_faces(tet_neighbours(mesh.tets, mesh.points.size()))) {
    mesh.boundary.push_back(face_of(mesh.tets[at.tet], at.opposite));
  }
  return mesh;
}

}  // namespace periost
