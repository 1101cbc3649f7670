#include "pipeline/geometry/tet_faces.h"

#include <algorithm>

#include "pipeline/base/error.h"

namespace periost {
namespace {

Triangle sorted_face(const Tetrahedron& tet, int k) {
  const auto [a, b, c] = face_of(tet, k);
  const Index low = std::min(a, b), high = std::max(a, b);
  return {std::min(low, c), std::max(low, std::min(high, c)), std::max(high, c)};
}

// A face by its other two corners, in the list of its smallest one.
struct ListedFace {
  Index middle = 0, largest = 0;
  Index next = kNoIndex;
  std::array<Index, 2> side{};  // 4 * tet + k of the first two that have it; fewer than 2^30 tetrahedra
  std::uint32_t uses = 0;
};

// The nodes in the middle of edges, filed under the edge's smaller end.
class EdgeNodes {
 public:
  explicit EdgeNodes(TetMesh& mesh) : mesh_(mesh), of_point_(mesh.points.size()) {}

  Index between(Index a, Index b) {
    if (a > b) std::swap(a, b);
    for (const auto& [other, node] : of_point_[a]) {
      if (other == b) return node;
    }
    const auto node = static_cast<Index>(mesh_.points.size());
    mesh_.points.push_back(0.5 * (mesh_.points[a] + mesh_.points[b]));
    for (auto& [name, values] : mesh_.point_fields) values.push_back(0.5F * (values[a] + values[b]));
    of_point_[a].emplace_back(b, node);
    return node;
  }

 private:
  TetMesh& mesh_;
  std::vector<std::vector<std::pair<Index, Index>>> of_point_;
};

}  // namespace

std::vector<TetNeighbours> tet_neighbours(const std::vector<Tetrahedron>& tets, std::size_t points) {
  PERIOST_ASSERT(tets.size() < kNoIndex / 4);
  std::vector<TetNeighbours> neighbours(tets.size(), {kNoIndex, kNoIndex, kNoIndex, kNoIndex});
  std::vector<Index> first(points, kNoIndex);
  std::vector<ListedFace> faces;
  faces.reserve(2 * tets.size() + tets.size() / 4);
  for (Index t = 0; t < tets.size(); ++t) {
    for (int k = 0; k < 4; ++k) {
      const auto [smallest, middle, largest] = sorted_face(tets[t], k);
      Index f = first[smallest];
      while (f != kNoIndex && (faces[f].middle != middle || faces[f].largest != largest)) f = faces[f].next;
      if (f == kNoIndex) {
        f = static_cast<Index>(faces.size());
        faces.push_back({middle, largest, first[smallest], {}, 0});
        first[smallest] = f;
      }
      ListedFace& face = faces[f];
      if (face.uses < 2) face.side[face.uses] = 4 * t + static_cast<Index>(k);
      if (++face.uses == 1) continue;
      const auto [one, other] = face.side;
      neighbours[one / 4][one % 4] = face.uses == 2 ? other / 4 : kNoIndex;
      neighbours[other / 4][other % 4] = face.uses == 2 ? one / 4 : kNoIndex;
    }
  }
  return neighbours;
}

std::vector<BoundaryFace> boundary_faces(const std::vector<TetNeighbours>& neighbours) {
  std::vector<BoundaryFace> faces;
  for (Index t = 0; t < neighbours.size(); ++t) {
    for (int k = 0; k < 4; ++k) {
      if (neighbours[t][static_cast<std::size_t>(k)] == kNoIndex) faces.push_back({t, k});
    }
  }
  return faces;
}

std::vector<Triangle> faces_between_regions(const TetMesh& mesh,
                                            const std::vector<TetNeighbours>& neighbours) {
  std::vector<Triangle> faces;
  for (std::size_t t = 0; t < mesh.region.size(); ++t) {
    for (int k = 0; k < 4; ++k) {
      const Index other = neighbours[t][static_cast<std::size_t>(k)];
      if (other != kNoIndex && mesh.region[t] < mesh.region[other]) faces.push_back(face_of(mesh.tets[t], k));
    }
  }
  return faces;
}

std::vector<std::uint32_t> tet_components(const std::vector<TetNeighbours>& neighbours) {
  std::vector<std::uint32_t> component(neighbours.size(), kNoIndex);
  std::vector<Index> open;
  std::uint32_t count = 0;
  for (Index start = 0; start < neighbours.size(); ++start) {
    if (component[start] != kNoIndex) continue;
    component[start] = count;
    open.push_back(start);
    while (!open.empty()) {
      const Index tet = open.back();
      open.pop_back();
      for (const Index other : neighbours[tet]) {
        if (other == kNoIndex || component[other] != kNoIndex) continue;
        component[other] = count;
        open.push_back(other);
      }
    }
    ++count;
  }
  return component;
}

void add_midside_nodes(TetMesh& mesh) {
  if (mesh.order() == 2) {
    for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
      for (std::size_t k = 0; k < 6; ++k) {
        const Index a = mesh.tets[t][static_cast<std::size_t>(kTetEdge[k][0])];
        const Index b = mesh.tets[t][static_cast<std::size_t>(kTetEdge[k][1])];
        mesh.points[mesh.midside[t][k]] = 0.5 * (mesh.points[a] + mesh.points[b]);
      }
    }
    return;
  }
  EdgeNodes nodes(mesh);
  mesh.midside.reserve(mesh.tets.size());
  for (const Tetrahedron& tet : mesh.tets) {
    MidsideNodes middle;
    for (std::size_t k = 0; k < 6; ++k) {
      middle[k] = nodes.between(tet[static_cast<std::size_t>(kTetEdge[k][0])],
                                tet[static_cast<std::size_t>(kTetEdge[k][1])]);
    }
    mesh.midside.push_back(middle);
  }
}

}  // namespace periost
